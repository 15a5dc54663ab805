// Pictures of a built graph, for `turnlight graph CONFIG`.
#pragma once

#include <string>

#include "nodes/graph/graph.h"

namespace turnlight::nodes::graph {

// Nodes in order with their ports, types and where each input comes from, for a terminal.
std::string DrawText(const GraphParts& parts);
// For Graphviz: sources are boxes, actions are dashed with the server's end marked.
std::string DrawDot(const GraphParts& parts);

}  // namespace turnlight::nodes::graph
