// The wall executor: one thread per node, the steady clock, real waiting.
//
// A node's queues, counters and flags are guarded by the mutex of its worker; its timers and its
// code belong to its thread alone. The thread that calls Run watches: deadlines, stop requests, and
// whether there is still work (queued messages, running handlers and armed timers are counted in
// one number). Locks are taken in the order: output port, then worker.
//
// wall_worker.cpp has what the nodes' threads do, wall_executor.cpp what the watching thread does.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "base/utc.h"
#include "nodes/graph/executor.h"

namespace turnlight::nodes::graph {

class WallExecutor final : public Runtime {
 public:
  WallExecutor(std::shared_ptr<GraphParts> parts, const RunOptions& options,
               std::shared_ptr<const LogWriter> log);
  // self keeps the executor alive for threads that hang.
  static RunEnd Run(const std::shared_ptr<WallExecutor>& self);

  void Publish(OutputPort& port, std::shared_ptr<const void> value, Time valid_at) override;
  void Report(NodeCore& node, Fault fault) override;
  Time Now() const override { return std::chrono::steady_clock::now() - began_; }
  std::string UtcLabel() const override { return UtcNow(); }
  void HoldStop(NodeCore& node, int change) override;
  void RequestStop(StopMode mode) override;
  bool StoppingNow() const override { return level() == 2; }

 private:
  static constexpr int kMaxSpinCredit = 4;  // misses in a row until a worker stops looking for news

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
    int spin_credit = kMaxSpinCredit;
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
  const std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
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

}  // namespace turnlight::nodes::graph
