#include "nodes/graph/executor.h"

#include <utility>

namespace turnlight::nodes::graph {

namespace {
constexpr std::size_t kMaxFaults = 1000;
}

void FaultList::Add(const Fault& fault) {
  const std::lock_guard lock(mutex_);
  if (faults_.size() < kMaxFaults) faults_.push_back(fault);
  ++count_;
  if (!fault.recoverable && !failure_) failure_ = fault;
  if (on_fault_) on_fault_(fault);
}

void FaultList::MoveTo(RunReport& report) {
  const std::lock_guard lock(mutex_);
  report.faults = std::move(faults_);
  report.fault_count = count_;
  report.failure = std::move(failure_);
  on_fault_ = nullptr;  // a thread that was left behind must not call into what may be gone
}

StopCause CauseOf(const GraphParts& parts, const RunReport& report) {
  if (report.failure) return StopCause::kFault;
  const int level = parts.stop_level.load();
  if (level == 2) return StopCause::kImmediate;
  return level == 1 ? StopCause::kRequested : StopCause::kCompleted;
}

void FillActions(GraphParts& parts, RunReport& report) {
  for (std::size_t i = 0; i < parts.nodes.size(); ++i)
    for (const ActionEnd* action : parts.core(i).actions)
      report.actions.push_back({parts.core(i).name + "." + action->name,
                                action->late.load(std::memory_order_relaxed),
                                action->duplicate.load(std::memory_order_relaxed)});
}

ConnectionReport ReportOf(const Connection& connection) {
  return {connection.from.Topic(), connection.to.Topic(), connection.delivered,
          connection.dropped,      connection.blocked,    connection.discarded};
}

}  // namespace turnlight::nodes::graph
