// What a replay feeds into a graph; used by Graph::Replay.
#pragma once

#include <string>

#include "base/result.h"
#include "nodes/graph/executor.h"

namespace turnlight::nodes::graph {

// Reads the whole log once and sorts its records by the source that published them. Fails (kInput)
// if the log is of another config or seed, or does not hold every topic that leads from a source to
// a node that runs. The reader must outlive the plan; name is the log's, for messages.
Result<ReplayPlan> PlanReplay(GraphParts& parts, LogReader& reader, const std::string& name);

}  // namespace turnlight::nodes::graph
