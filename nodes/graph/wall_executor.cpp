#include "nodes/graph/wall_executor.h"

#include <algorithm>
#include <utility>

#include "base/format.h"

namespace turnlight::nodes::graph {
namespace {

using namespace std::chrono_literals;

constexpr Duration kLongestTick = 5ms;

}  // namespace

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
    Report(*worker->core,
           {worker->core->name, "deadline",
            Format("a handler runs for %.3f ms, allowed are %.3f ms", ToMs(took), ToMs(*deadline)),
            true});
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
  const auto until = std::chrono::steady_clock::now() + options_.hang_grace;
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

RunEnd RunWall(std::shared_ptr<GraphParts> parts, const RunOptions& options,
               std::shared_ptr<const LogWriter> log) {
  return WallExecutor::Run(
      std::make_shared<WallExecutor>(std::move(parts), options, std::move(log)));
}

}  // namespace turnlight::nodes::graph
