// The virtual executor: one thread, a clock that jumps, one order of delivery.
//
// Time goes from instant to instant. At an instant, first every node whose handler ends now
// publishes what the handler put out, in the order of declaration; then every idle node with
// something to do begins its next handler, in the same order. A handler takes its node's declared
// duration and at least 1 ns, so an effect is always later than its cause: what happens at one
// instant in one node cannot depend on what happens at it in another. That makes the order total,
// and a replay exact.
#include <algorithm>
#include <cstdio>
#include <utility>

#include "nodes/graph/executor.h"

namespace turnlight::nodes::graph {
namespace {

constexpr Duration kTick(1);

class VirtualExecutor final : public Runtime {
 public:
  VirtualExecutor(GraphParts& parts, const RunOptions& options, const LogWriter* log,
                  const ReplayPlan* replay);
  RunEnd Run();

  void Publish(OutputPort& port, std::shared_ptr<const void> value, Time valid_at) override;
  void Report(NodeCore& node, Fault fault) override;
  Time Now() const override { return now_; }
  std::string UtcLabel() const override;
  void HoldStop(NodeCore& node, int change) override;
  void RequestStop(StopMode mode) override { Graph::RaiseStop(parts_, mode); }
  bool StoppingNow() const override { return parts_.stop_level.load() == 2; }

 private:
  enum class Phase { kRunning, kWindingDown, kDraining };
  enum class Control { kNone, kStart, kWindDown };

  struct Staged {
    OutputPort* port = nullptr;
    AnyMessage message;
    bool observed = false;
  };
  // One node on its way through time.
  struct Lane {
    NodeCore* core = nullptr;
    bool replaced = false;  // by a log
    bool halted = false;    // by a fault
    bool busy = false;
    Time free_at{};  // of a busy lane: when its handler ends; kNever while it waits for room
    Control control = Control::kStart;
    Time control_at{};
    int holds = 0;
    std::vector<Staged> staged;
    std::size_t next_staged = 0;
    std::size_t next_connection = 0;
    const Connection* blocked_on = nullptr;
    std::size_t next_entry = 0;  // of a replaced lane
  };

  Time NextTime() const;
  bool EndInstant();
  bool AdvanceWhenIdle();
  void BeginWindDown();
  void BeginDrain() { phase_ = Phase::kDraining; }
  bool WoundDown() const;

  void CommitIfDue(Lane& lane);
  void Commit(Lane& lane);
  void Deliver(Connection& connection, AnyMessage&& message);
  void StageReplay(Lane& lane);
  void AwaitReplay(Lane& lane);
  void StartIfIdle(Lane& lane);
  void HandleMessage(Lane& lane, Connection& connection);
  void WakeBlocked(const Connection& connection);
  template <typename Call>
  void RunHandler(Lane& lane, std::string_view what, std::string_view port, Duration cost,
                  Call&& call);
  void Halt(Lane& lane);
  void Fail(std::string code, std::string text);
  void StopNodes();

  GraphParts& parts_;
  const LogWriter* log_;
  const ReplayPlan* replay_;
  FaultList faults_;
  RunReport report_;
  LogStop stop_;
  std::vector<Lane> lanes_;
  Lane* current_ = nullptr;  // whose handler runs
  Duration current_cost_{0};
  Time now_{};
  Phase phase_ = Phase::kRunning;
  std::uint64_t arrivals_ = 0;
  bool log_failed_ = false;
};

VirtualExecutor::VirtualExecutor(GraphParts& parts, const RunOptions& options, const LogWriter* log,
                                 const ReplayPlan* replay)
    : parts_(parts), log_(log), replay_(replay), faults_(options.on_fault) {
  lanes_.resize(parts.nodes.size());
  for (std::size_t i = 0; i < lanes_.size(); ++i) {
    Lane& lane = lanes_[i];
    lane.core = &parts.core(i);
    lane.core->runtime = this;
    lane.staged.reserve(16);
    lane.replaced = replay && lane.core->is_source;
    if (!lane.replaced) continue;
    lane.control = Control::kNone;
    AwaitReplay(lane);
  }
}

RunEnd VirtualExecutor::Run() {
  while (true) {
    const Time next = NextTime();
    if (next == kNever) {
      if (AdvanceWhenIdle()) continue;
      break;
    }
    now_ = next;
    for (Lane& lane : lanes_) CommitIfDue(lane);
    for (Lane& lane : lanes_) StartIfIdle(lane);
    if (EndInstant()) break;
  }
  StopNodes();
  faults_.MoveTo(report_);
  report_.cause = CauseOf(parts_, report_);
  report_.ended_at = now_;
  for (const auto& connection : parts_.connections)
    report_.connections.push_back(ReportOf(*connection));
  FillActions(parts_, report_);
  return {std::move(report_), stop_};
}

Time VirtualExecutor::NextTime() const {
  Time next = kNever;
  for (const Lane& lane : lanes_) {
    if (lane.busy)
      next = std::min(next, lane.free_at);
    else if (lane.control != Control::kNone)
      next = std::min(next, lane.control_at);
    else if (!lane.halted && !lane.replaced)
      next = std::min(next, NextDue(*lane.core));
  }
  if (replay_ && replay_->stop && phase_ == Phase::kRunning)
    next = std::min(next, std::max(now_, replay_->stop->at));
  return next;
}

// After the handlers of an instant: stops and drains. True if the run ends here.
bool VirtualExecutor::EndInstant() {
  if (log_ && log_->failed() && !log_failed_) {
    log_failed_ = true;
    Fail("log", log_->status().error().text);
  }
  int level = parts_.stop_level.load(std::memory_order_relaxed);
  if (replay_ && replay_->stop && now_ >= replay_->stop->at && phase_ == Phase::kRunning)
    level = std::max(level, replay_->stop->mode == StopMode::kNow ? 2 : 1);
  if (level == 2) {
    stop_ = {StopMode::kNow, now_};
    return true;
  }
  if (level == 1 && phase_ == Phase::kRunning) BeginWindDown();
  if (phase_ == Phase::kWindingDown && WoundDown()) BeginDrain();
  if (phase_ == Phase::kDraining)
    for (Lane& lane : lanes_) CancelTimers(*lane.core, false);
  return false;
}

// Nothing will happen by itself any more. False if that is the end.
bool VirtualExecutor::AdvanceWhenIdle() {
  if (phase_ == Phase::kRunning)
    BeginWindDown();
  else if (phase_ == Phase::kWindingDown)
    BeginDrain();  // somebody holds the stop, but nothing is left that could release it
  else
    return false;
  return true;
}

void VirtualExecutor::BeginWindDown() {
  phase_ = Phase::kWindingDown;
  stop_ = {StopMode::kDrain, now_};
  for (Lane& lane : lanes_) {
    if (lane.halted || lane.replaced) continue;
    lane.control = Control::kWindDown;
    lane.control_at = now_ + kTick;
  }
}

bool VirtualExecutor::WoundDown() const {
  return std::all_of(lanes_.begin(), lanes_.end(), [](const Lane& lane) {
    return lane.control == Control::kNone && lane.holds <= 0;
  });
}

void VirtualExecutor::CommitIfDue(Lane& lane) {
  if (!lane.busy || lane.free_at != now_) return;
  if (lane.replaced && lane.staged.empty()) StageReplay(lane);
  Commit(lane);
}

// Delivers what the lane's last handler put out, as far as there is room.
void VirtualExecutor::Commit(Lane& lane) {
  for (; lane.next_staged < lane.staged.size(); ++lane.next_staged) {
    Staged& staged = lane.staged[lane.next_staged];
    if (!staged.observed) Observe(*staged.port, staged.message);
    staged.observed = true;
    const auto& connections = staged.port->connections;
    for (; lane.next_connection < connections.size(); ++lane.next_connection) {
      Connection& connection = *connections[lane.next_connection];
      const bool last = lane.next_connection + 1 == connections.size();
      if (connection.queue.policy().block() && connection.queue.full()) {
        ++connection.blocked;
        lane.blocked_on = &connection;
        lane.free_at = kNever;
        return;
      }
      Deliver(connection, last ? std::move(staged.message) : AnyMessage(staged.message));
    }
    lane.next_connection = 0;
  }
  lane.staged.clear();
  lane.next_staged = 0;
  lane.busy = false;
  if (lane.replaced) AwaitReplay(lane);
}

// There is room for it, or the oldest makes place.
void VirtualExecutor::Deliver(Connection& connection, AnyMessage&& message) {
  const Lane& to = lanes_[connection.to.node.index];
  if (to.halted || to.replaced) {
    ++connection.discarded;
    return;
  }
  const auto pushed = connection.queue.Push(std::move(message), arrivals_++, now_);
  if (pushed == MessageQueue::Pushed::kReplacedOldest) ++connection.dropped;
  ++connection.delivered;
}

void VirtualExecutor::StageReplay(Lane& lane) {
  const auto& entries = replay_->entries[lane.core->index];
  std::string problem;
  for (; problem.empty() && lane.next_entry < entries.size() && entries[lane.next_entry].at <= now_;
       ++lane.next_entry) {
    const ReplayPlan::Entry& entry = entries[lane.next_entry];
    const auto record = replay_->reader->ReadAt(entry.offset);
    if (!record) {
      problem = record.error().text;
      continue;
    }
    auto value = DecodeMessage(entry.port->type, record->bytes);
    if (value)
      lane.staged.push_back({entry.port, {record->header, std::move(*value)}, false});
    else
      problem = entry.port->Topic() + " #" + std::to_string(record->header.sequence) + ": " +
                value.error().text;
  }
  if (problem.empty()) return;
  lane.next_entry = entries.size();  // what follows would come after a gap
  Fail("log", problem);
}

void VirtualExecutor::AwaitReplay(Lane& lane) {
  const auto& entries = replay_->entries[lane.core->index];
  lane.busy = lane.next_entry < entries.size();
  if (lane.busy) lane.free_at = std::max(entries[lane.next_entry].at, now_ + kTick);
}

void VirtualExecutor::StartIfIdle(Lane& lane) {
  if (lane.busy || lane.halted || lane.replaced) return;
  NodeCore& core = *lane.core;
  const Control control = std::exchange(lane.control, Control::kNone);
  if (control == Control::kStart)
    return RunHandler(lane, "start", "", kTick, [&core] { return core.node->Start(); });
  if (control == Control::kWindDown)
    return RunHandler(lane, "wind down", "", kTick, [&core] { return core.node->WindDown(); });
  const NextWork work = ChooseWork(core, now_);
  if (work.timer) {
    ++report_.handled;
    RunHandler(lane, "timer", work.timer->name, core.duration,
               [this, &work] { return FireTimer(*work.timer, now_); });
  } else if (work.connection) {
    HandleMessage(lane, *work.connection);
  }
}

void VirtualExecutor::HandleMessage(Lane& lane, Connection& connection) {
  ++report_.handled;
  AnyMessage message = connection.queue.Pop();
  WakeBlocked(connection);
  RunHandler(lane, "input", connection.to.name, lane.core->duration,
             [&] { return connection.to.handler(std::move(message)); });
}

// Room was made: the publisher that waits for it goes on 1 ns later.
void VirtualExecutor::WakeBlocked(const Connection& connection) {
  Lane& from = lanes_[connection.from.node.index];
  if (from.blocked_on != &connection) return;
  from.blocked_on = nullptr;
  from.free_at = now_ + kTick;
}

template <typename Call>
void VirtualExecutor::RunHandler(Lane& lane, std::string_view what, std::string_view port,
                                 Duration cost, Call&& call) {
  using RealClock = std::chrono::steady_clock;
  const auto& deadline = lane.core->deadline;
  const auto began = deadline ? RealClock::now() : RealClock::time_point();
  lane.busy = true;
  lane.free_at = now_ + cost;
  current_ = &lane;
  current_cost_ = cost;
  if (const auto fault = Guarded(*lane.core, what, port, std::forward<Call>(call)))
    Report(*lane.core, *fault);
  current_ = nullptr;
  if (!deadline) return;
  // Told in the report only: real time must not change what a virtual run publishes.
  const Duration took = RealClock::now() - began;
  if (took > *deadline) report_.overruns.push_back({lane.core->name, took, *deadline});
}

void VirtualExecutor::Publish(OutputPort& port, std::shared_ptr<const void> value, Time valid_at) {
  if (!current_ || &port.node != current_->core) return;
  current_->staged.push_back(
      {&port, {{port.next_sequence++, valid_at, now_ + current_cost_}, std::move(value)}, false});
}

void VirtualExecutor::Report(NodeCore& node, Fault fault) {
  faults_.Add(fault);
  const bool fatal = !fault.recoverable;
  Publish(*node.outputs[0], std::make_shared<const Fault>(std::move(fault)), now_);
  if (!fatal) return;
  RequestStop(StopMode::kDrain);
  Halt(lanes_[node.index]);
}

void VirtualExecutor::Halt(Lane& lane) {
  lane.halted = true;
  lane.control = Control::kNone;
  lane.holds = 0;
  CancelTimers(*lane.core, true);
  for (Connection* connection : lane.core->incoming) {
    connection->discarded += connection->queue.size();
    connection->queue.Clear();
    WakeBlocked(*connection);
  }
}

// A failure of the run itself, not of a node.
void VirtualExecutor::Fail(std::string code, std::string text) {
  faults_.Add({"graph", std::move(code), std::move(text), false});
  RequestStop(StopMode::kDrain);
}

void VirtualExecutor::HoldStop(NodeCore& node, int change) { lanes_[node.index].holds += change; }

std::string VirtualExecutor::UtcLabel() const {
  char text[40];
  const auto ns = static_cast<long long>(now_.count());
  std::snprintf(text, sizeof text, "virtual+%lld.%09llds", ns / 1'000'000'000, ns % 1'000'000'000);
  return text;
}

void VirtualExecutor::StopNodes() {
  for (Lane& lane : lanes_) {
    NodeCore& core = *lane.core;
    if (!lane.replaced) {
      const auto fault =
          Guarded(core, "stop", "", [this, &core] { return core.node->Stop(stop_.mode); });
      if (fault) faults_.Add(*fault);
    }
    core.runtime = nullptr;
  }
}

}  // namespace

RunEnd RunVirtual(GraphParts& parts, const RunOptions& options, const LogWriter* log,
                  const ReplayPlan* replay) {
  return VirtualExecutor(parts, options, log, replay).Run();
}

}  // namespace turnlight::nodes::graph
