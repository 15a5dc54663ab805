// Between Graph::Run and the two executors; not for nodes.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "nodes/graph/graph.h"
#include "nodes/graph/log.h"

namespace turnlight::nodes::graph {

// What a replay publishes in the place of the sources.
struct ReplayPlan {
  struct Entry {
    Time at{};
    std::uint64_t offset = 0;  // in the log
    OutputPort* port = nullptr;
  };
  LogReader* reader = nullptr;
  std::vector<std::vector<Entry>> entries;  // of each node, in the log's order
  std::optional<LogStop> stop;              // of a log that was closed
};

struct RunEnd {
  RunReport report;
  LogStop stop;
};

// Faults as they come, from any thread.
class FaultList {
 public:
  explicit FaultList(std::function<void(const Fault&)> on_fault) : on_fault_(std::move(on_fault)) {}
  void Add(const Fault& fault);
  // The faults, their number and the failure.
  void MoveTo(RunReport& report);

 private:
  std::mutex mutex_;
  std::function<void(const Fault&)> on_fault_;
  std::vector<Fault> faults_;
  std::uint64_t count_ = 0;
  std::optional<Fault> failure_;
};

// The cause, as far as the stop level and the faults tell it.
StopCause CauseOf(const GraphParts& parts, const RunReport& report);
void FillActions(GraphParts& parts, RunReport& report);
ConnectionReport ReportOf(const Connection& connection);

// log may be null. The graph is configured.
RunEnd RunVirtual(GraphParts& parts, const RunOptions& options, const LogWriter* log,
                  const ReplayPlan* replay);
// Threads that hang keep the parts and the log alive.
RunEnd RunWall(std::shared_ptr<GraphParts> parts, const RunOptions& options,
               std::shared_ptr<const LogWriter> log);

}  // namespace turnlight::nodes::graph
