#include <algorithm>
#include <utility>

#include "nodes/graph/wall_executor.h"

namespace turnlight::nodes::graph {
namespace {

using RealClock = std::chrono::steady_clock;
using namespace std::chrono_literals;

// Waking a thread on an idle processor takes about 9 us; a thread that looks for news instead of
// sleeping gets it in 1 us. That pays only while the sender runs on another processor: a worker
// that looked in vain a few times in a row goes to sleep at once from then on, and tries again now
// and then.
constexpr Duration kSpin = 25us;  // longer than a wake-up, or two workers never come into step
constexpr int kProbeEvery = 64;   // waits until it tries again

void Pause() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#endif
}

}  // namespace

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
  worker.spin_credit = kMaxSpinCredit;
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

}  // namespace turnlight::nodes::graph
