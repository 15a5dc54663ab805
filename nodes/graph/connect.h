// Wires the nodes of a graph as its config says, and checks the result. Used by Graph::Build.
#pragma once

#include "base/result.h"
#include "nodes/graph/graph.h"

namespace turnlight::nodes::graph {

// Fills parts.connections, the ports' lists of them, and parts.recorded.
Status Connect(GraphParts& parts);

}  // namespace turnlight::nodes::graph
