// The wall executor: one thread per node, the steady clock, real waiting.
//
// A node's queues, counters and flags are guarded by the mutex of its worker; its timers and its
// code belong to its thread alone. The thread that calls Run watches: deadlines, stop requests, and
// whether there is still work (queued messages, running handlers and armed timers are counted in
// one number). Locks are taken in the order: output port, then worker.
#include <algorithm>
#include <condition_variable>
#include <cstdio>
#include <ctime>
#include <thread>
#include <utility>

#include "nodes/graph/executor.h"

namespace turnlight::graph {
namespace {

using RealClock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr Duration kLongestTick = 5ms;
// Waking a thread on an idle processor takes about 9 us; a thread that looks for news instead of
// sleeping gets it in 1 us. That pays only while the sender runs on another processor: a worker
// that looked in vain a few times in a row goes to sleep at once from then on, and tries again now
// and then.
constexpr Duration kSpin = 25us;  // longer than a wake-up, or two workers never come into step
constexpr int kMaxCredit = 4;     // misses in a row until it stops looking
constexpr int kProbeEvery = 64;   // waits until it tries again

void Pause() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#endif
}

class WallExecutor final : public Runtime {
 public:
  WallExecutor(std::shared_ptr<GraphParts> parts, const RunOptions& options,
               std::shared_ptr<const LogWriter> log);
  // self keeps the executor alive for threads that hang.
  static RunEnd Run(const std::shared_ptr<WallExecutor>& self);

  void Publish(OutputPort& port, std::shared_ptr<const void> value, Time valid_at) override;
  void Report(NodeCore& node, Fault fault) override;
  Time Now() const override { return RealClock::now() - began_; }
  std::string UtcLabel() const override;
  void HoldStop(NodeCore& node, int change) override;
  void RequestStop(StopMode mode) override;
  bool StoppingNow() const override { return level() == 2; }

 private:
  enum class Phase { kRunning, kWindingDown, kDraining, kStopping };
  enum class Control { kNone, kWindDown, kStop };

  struct Worker {
    NodeCore* core = nullptr;
    std::thread thread;

    std::mutex mutex;
    std::condition_variable wake;   // of the worker
    std::condition_variable space;  // of publishers that wait for room
    int waiting = 0;                // how many do
    bool sleeping = false;
    bool closed = false;  // takes no more messages
    Control control = Control::kNone;
    std::uint64_t arrivals = 0;

    std::atomic<std::uint64_t> signals{0};  // goes up whenever there may be something new to do
    std::atomic<std::int64_t> handler_began{-1};
    std::atomic<bool> stopped{false};
    std::atomic<int> holds{0};

    std::atomic<bool> publishing{true};

    // Only its own thread.
    bool halted = false;
    int armed = 0;
    int spin_credit = kMaxCredit;
    int waits = 0;
    std::uint64_t handled = 0;

    std::int64_t overrun_told = -1;  // only the watching thread: which handler was reported
  };

  // The workers' side.
  void WorkerMain(Worker& worker);
  struct Work {
    Control control = Control::kNone;
    bool stop_now = false;
    TimerPort* timer = nullptr;
    Connection* connection = nullptr;
    AnyMessage message;
  };
  Work NextWorkOf(Worker& worker);
  bool TakeWork(Worker& worker, Work& work);
  static void Spin(Worker& worker, std::uint64_t seen);
  void Sleep(Worker& worker, std::unique_lock<std::mutex>& lock);
  template <typename Call>
  void RunHandler(Worker& worker, std::string_view what, std::string_view port, Call&& call);
  void CountArmed(Worker& worker);
  void AddWork(int change);
  void TellWatcher();
  void Deliver(Connection& connection, const AnyMessage& message);
  void Close(Worker& worker);
  void StopNode(Worker& worker, StopMode mode);

  // The watching side.
  RunEnd Watch();
  void WaitForNews(Duration tick);
  Duration Tick() const;
  bool StepPhase();
  void Post(Worker& worker, Control control);
  void WakeAll();
  void CheckDeadlines();
  void CheckLog();
  bool StopNextInOrder();
  void StopAllNow();
  void JoinOrLeave();
  RunEnd Finish();

  int level() const { return parts_->stop_level.load(std::memory_order_relaxed); }

  const std::shared_ptr<GraphParts> parts_;
  const RunOptions options_;
  const std::shared_ptr<const LogWriter> log_;
  const RealClock::time_point began_ = RealClock::now();
  FaultList faults_;
  std::vector<std::unique_ptr<Worker>> workers_;
  RunReport report_;
  LogStop stop_;
  bool log_failed_ = false;
  std::size_t next_to_stop_ = 0;

  std::atomic<Phase> phase_{Phase::kRunning};
  std::atomic<bool> now_{false};       // stop now was begun
  std::atomic<std::int64_t> work_{0};  // queued messages, running handlers, armed timers
  std::atomic<int> to_wind_down_{0};
  std::mutex news_mutex_;
  std::condition_variable news_;
  bool has_news_ = false;
};

WallExecutor::WallExecutor(std::shared_ptr<GraphParts> parts, const RunOptions& options,
                           std::shared_ptr<const LogWriter> log)
    : parts_(std::move(parts)), options_(options), log_(std::move(log)), faults_(options.on_fault) {
  for (std::size_t i = 0; i < parts_->nodes.size(); ++i) {
    workers_.push_back(std::make_unique<Worker>());
    workers_.back()->core = &parts_->core(i);
    parts_->core(i).runtime = this;
  }
}

RunEnd WallExecutor::Run(const std::shared_ptr<WallExecutor>& self) {
  self->work_ = static_cast<std::int64_t>(self->workers_.size());  // every Start
  for (auto& worker : self->workers_) {
    Worker* one = worker.get();
    worker->thread = std::thread([self, one] { self->WorkerMain(*one); });
  }
  return self->Watch();
}

// ---- the workers' side ----

void WallExecutor::WorkerMain(Worker& worker) {
  NodeCore& core = *worker.core;
  RunHandler(worker, "start", "", [&core] { return core.node->Start(); });
  AddWork(-1);
  while (true) {
    Work work = NextWorkOf(worker);
    if (work.stop_now) return StopNode(worker, StopMode::kNow);
    if (work.control == Control::kStop) return StopNode(worker, StopMode::kDrain);
    if (work.control == Control::kWindDown) {
      if (!worker.halted)
        RunHandler(worker, "wind down", "", [&core] { return core.node->WindDown(); });
      to_wind_down_.fetch_sub(1);
      AddWork(-1);
    } else if (work.timer) {
      ++worker.handled;
      RunHandler(worker, "timer", work.timer->name, [&] { return FireTimer(*work.timer, Now()); });
    } else {
      ++worker.handled;
      RunHandler(worker, "input", work.connection->to.name,
                 [&] { return work.connection->to.handler(std::move(work.message)); });
      AddWork(-1);
    }
  }
}

// Waits until there is something to do.
WallExecutor::Work WallExecutor::NextWorkOf(Worker& worker) {
  Work work;
  std::unique_lock lock(worker.mutex);
  if (TakeWork(worker, work)) return work;
  if (worker.spin_credit > 0 || ++worker.waits % kProbeEvery == 0) {
    const std::uint64_t seen = worker.signals.load(std::memory_order_relaxed);
    lock.unlock();
    Spin(worker, seen);
    lock.lock();
  }
  while (!TakeWork(worker, work)) Sleep(worker, lock);
  return work;
}

void WallExecutor::Spin(Worker& worker, std::uint64_t seen) {
  const auto until = RealClock::now() + kSpin;
  while (worker.signals.load(std::memory_order_acquire) == seen) {
    if (RealClock::now() > until) {
      worker.spin_credit = std::max(worker.spin_credit - 1, 0);
      return;
    }
    for (int i = 0; i < 8; ++i) Pause();
  }
  worker.spin_credit = kMaxCredit;
}

// With the worker's mutex held. False if there is nothing to do at this moment.
bool WallExecutor::TakeWork(Worker& worker, Work& work) {
  if (now_.load(std::memory_order_acquire)) {
    work.stop_now = true;
    return true;
  }
  if (worker.control != Control::kNone) {
    work.control = std::exchange(worker.control, Control::kNone);
    return true;
  }
  if (phase_.load(std::memory_order_acquire) >= Phase::kDraining) {
    CancelTimers(*worker.core, false);
    CountArmed(worker);
  }
  const NextWork next = ChooseWork(*worker.core, Now());
  work.timer = next.timer;
  work.connection = next.connection;
  if (next.connection) {
    work.message = next.connection->queue.Pop();
    if (worker.waiting > 0) worker.space.notify_all();
  }
  return next.timer || next.connection;
}

void WallExecutor::Sleep(Worker& worker, std::unique_lock<std::mutex>& lock) {
  const Time due = NextDue(*worker.core);
  worker.sleeping = true;
  if (due == kNever)
    worker.wake.wait(lock);
  else
    worker.wake.wait_until(lock, began_ + due);
  worker.sleeping = false;
}

template <typename Call>
void WallExecutor::RunHandler(Worker& worker, std::string_view what, std::string_view port,
                              Call&& call) {
  if (worker.core->deadline) worker.handler_began.store(Now().count(), std::memory_order_release);
  if (const auto fault = Guarded(*worker.core, what, port, std::forward<Call>(call)))
    Report(*worker.core, *fault);
  if (worker.core->deadline) worker.handler_began.store(-1, std::memory_order_release);
  CountArmed(worker);
}

// Brings the count of work up to date with the timers that this thread armed or let go.
void WallExecutor::CountArmed(Worker& worker) {
  int armed = 0;
  for (const TimerPort* timer : worker.core->timers) armed += timer->armed() ? 1 : 0;
  if (armed != worker.armed) AddWork(armed - std::exchange(worker.armed, armed));
}

void WallExecutor::AddWork(int change) {
  if (work_.fetch_add(change, std::memory_order_acq_rel) + change > 0) return;
  TellWatcher();
}

void WallExecutor::TellWatcher() {
  const std::lock_guard lock(news_mutex_);
  has_news_ = true;
  news_.notify_one();
}

void WallExecutor::Publish(OutputPort& port, std::shared_ptr<const void> value, Time valid_at) {
  if (StoppingNow() || !workers_[port.node.index]->publishing.load(std::memory_order_relaxed))
    return;
  AnyMessage message{{0, valid_at, Time(0)}, std::move(value)};
  // Only the port "fault" has a second publisher, the watching thread; it never blocks.
  std::unique_lock lock(port.mutex, std::defer_lock);
  if (&port == port.node.outputs[0]) lock.lock();
  message.header.sequence = port.next_sequence++;
  message.header.processed_at = Now();
  if (lock.owns_lock()) lock.unlock();
  Observe(port, message);
  for (Connection* connection : port.connections) Deliver(*connection, message);
}

void WallExecutor::Deliver(Connection& connection, const AnyMessage& message) {
  Worker& to = *workers_[connection.to.node.index];
  std::unique_lock lock(to.mutex);
  if (connection.queue.policy().block() && connection.queue.full() && !to.closed) {
    ++connection.blocked;
    ++to.waiting;
    to.space.wait(lock, [&] { return to.closed || !connection.queue.full(); });
    --to.waiting;
  }
  if (to.closed) {
    ++connection.discarded;
    return;
  }
  const auto pushed = connection.queue.Push(AnyMessage(message), to.arrivals++, Now());
  ++connection.delivered;
  if (pushed == MessageQueue::Pushed::kReplacedOldest)
    ++connection.dropped;
  else
    AddWork(1);
  to.signals.fetch_add(1, std::memory_order_release);
  const bool sleeping = to.sleeping;
  lock.unlock();
  if (sleeping) to.wake.notify_one();
}

void WallExecutor::Report(NodeCore& node, Fault fault) {
  faults_.Add(fault);
  const bool fatal = !fault.recoverable;
  Publish(*node.outputs[0], std::make_shared<const Fault>(std::move(fault)), Now());
  if (!fatal) return;
  Worker& worker = *workers_[node.index];
  worker.halted = true;
  worker.holds = 0;
  CancelTimers(node, true);
  Close(worker);
  RequestStop(StopMode::kDrain);
}

// Takes no more messages, throws away those that wait, and lets publishers go on.
void WallExecutor::Close(Worker& worker) {
  int thrown_away = 0;
  {
    const std::lock_guard lock(worker.mutex);
    worker.closed = true;
    for (Connection* connection : worker.core->incoming) {
      connection->discarded += connection->queue.size();
      thrown_away += static_cast<int>(connection->queue.size());
      connection->queue.Clear();
    }
    worker.space.notify_all();
  }
  if (thrown_away > 0) AddWork(-thrown_away);
}

void WallExecutor::StopNode(Worker& worker, StopMode mode) {
  Close(worker);
  worker.publishing = false;
  NodeCore& core = *worker.core;
  const auto fault = Guarded(core, "stop", "", [&core, mode] { return core.node->Stop(mode); });
  if (fault) faults_.Add(*fault);
  worker.stopped.store(true, std::memory_order_release);
  TellWatcher();
}

void WallExecutor::HoldStop(NodeCore& node, int change) {
  if (workers_[node.index]->holds.fetch_add(change) + change > 0) return;
  TellWatcher();
}

void WallExecutor::RequestStop(StopMode mode) {
  Graph::RaiseStop(*parts_, mode);
  TellWatcher();
}

std::string WallExecutor::UtcLabel() const {
  const auto now = std::chrono::system_clock::now();
  const std::time_t seconds = std::chrono::system_clock::to_time_t(now);
  const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(
                      now - std::chrono::system_clock::from_time_t(seconds))
                      .count();
  std::tm utc{};
  ::gmtime_r(&seconds, &utc);
  char day[32];
  std::strftime(day, sizeof day, "%Y-%m-%dT%H:%M:%S", &utc);
  char text[48];
  std::snprintf(text, sizeof text, "%s.%03dZ", day, static_cast<int>(ms));
  return text;
}

// ---- the watching side ----

RunEnd WallExecutor::Watch() {
  const Duration tick = Tick();
  while (StepPhase()) {
    WaitForNews(tick);
    CheckDeadlines();
    CheckLog();
  }
  JoinOrLeave();
  return Finish();
}

void WallExecutor::WaitForNews(Duration tick) {
  std::unique_lock lock(news_mutex_);
  news_.wait_for(lock, tick, [this] { return has_news_; });
  has_news_ = false;
}

// Often enough to see a deadline within a quarter of it, and a signal handler's request soon.
Duration WallExecutor::Tick() const {
  Duration tick = kLongestTick;
  for (const auto& worker : workers_)
    if (worker->core->deadline) tick = std::min(tick, *worker->core->deadline / 4);
  return std::max(tick, Duration(500us));
}

// One step towards the end, if it is time for it. False when every node has stopped.
bool WallExecutor::StepPhase() {
  const bool idle = work_.load(std::memory_order_acquire) <= 0;
  if (level() == 2) {
    StopAllNow();
    return false;
  }
  if (phase_ == Phase::kRunning && (level() == 1 || idle)) {
    stop_ = {StopMode::kDrain, Now()};
    to_wind_down_ = static_cast<int>(workers_.size());
    AddWork(to_wind_down_);
    phase_ = Phase::kWindingDown;
    for (auto& worker : workers_) Post(*worker, Control::kWindDown);
    return true;
  }
  if (phase_ == Phase::kWindingDown && to_wind_down_ == 0) {
    const bool held = std::any_of(workers_.begin(), workers_.end(),
                                  [](const auto& worker) { return worker->holds > 0; });
    if (held && !idle) return true;
    phase_ = Phase::kDraining;
    WakeAll();
    return true;
  }
  if (phase_ == Phase::kDraining && idle) {
    phase_ = Phase::kStopping;
    Post(*workers_[0], Control::kStop);
    return true;
  }
  return phase_ != Phase::kStopping || StopNextInOrder();
}

bool WallExecutor::StopNextInOrder() {
  if (!workers_[next_to_stop_]->stopped.load(std::memory_order_acquire)) return true;
  if (++next_to_stop_ == workers_.size()) return false;
  Post(*workers_[next_to_stop_], Control::kStop);
  return true;
}

void WallExecutor::Post(Worker& worker, Control control) {
  const std::lock_guard lock(worker.mutex);
  worker.control = control;
  worker.signals.fetch_add(1, std::memory_order_release);
  worker.wake.notify_one();
}

void WallExecutor::WakeAll() {
  for (auto& worker : workers_) {
    const std::lock_guard lock(worker->mutex);
    worker->wake.notify_one();
  }
}

void WallExecutor::CheckDeadlines() {
  for (auto& worker : workers_) {
    const auto& deadline = worker->core->deadline;
    const std::int64_t began = worker->handler_began.load(std::memory_order_acquire);
    if (!deadline || began < 0 || began == worker->overrun_told) continue;
    const Duration took = Now() - Duration(began);
    if (took <= *deadline) continue;
    worker->overrun_told = began;
    report_.overruns.push_back({worker->core->name, took, *deadline});
    char text[120];
    std::snprintf(text, sizeof text, "a handler runs for %.3f ms, allowed are %.3f ms", ToMs(took),
                  ToMs(*deadline));
    Report(*worker->core, {worker->core->name, "deadline", text, true});
  }
}

void WallExecutor::CheckLog() {
  if (!log_ || log_failed_ || !log_->failed()) return;
  log_failed_ = true;
  faults_.Add({"graph", "log", log_->status().error().text, false});
  RequestStop(StopMode::kDrain);
}

void WallExecutor::StopAllNow() {
  stop_ = {StopMode::kNow, Now()};
  now_.store(true, std::memory_order_release);
  for (auto& worker : workers_) Close(*worker);
  WakeAll();
}

// Waits for every thread; those whose node does not return in time are left behind.
void WallExecutor::JoinOrLeave() {
  const auto until = RealClock::now() + options_.hang_grace;
  for (auto& worker : workers_) {
    std::unique_lock lock(news_mutex_);
    news_.wait_until(lock, until, [&] { return worker->stopped.load(std::memory_order_acquire); });
    lock.unlock();
    if (worker->stopped.load(std::memory_order_acquire)) {
      worker->thread.join();
    } else {
      worker->thread.detach();
      report_.hung.push_back(worker->core->name);
    }
  }
}

RunEnd WallExecutor::Finish() {
  for (auto& worker : workers_) {
    const auto& hung = report_.hung;
    if (std::find(hung.begin(), hung.end(), worker->core->name) != hung.end()) continue;
    report_.handled += worker->handled;
    worker->core->runtime = nullptr;
  }
  faults_.MoveTo(report_);
  report_.cause = CauseOf(*parts_, report_);
  report_.ended_at = Now();
  for (const auto& connection : parts_->connections) {
    const std::lock_guard lock(workers_[connection->to.node.index]->mutex);
    report_.connections.push_back(ReportOf(*connection));
  }
  FillActions(*parts_, report_);
  return {std::move(report_), stop_};
}

}  // namespace

RunEnd RunWall(std::shared_ptr<GraphParts> parts, const RunOptions& options,
               std::shared_ptr<const LogWriter> log) {
  return WallExecutor::Run(
      std::make_shared<WallExecutor>(std::move(parts), options, std::move(log)));
}

}  // namespace turnlight::graph
