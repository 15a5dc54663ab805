// Hands every fault to whoever shows it, as one line of text.
//   in       faults  Fault, from any number of nodes
#pragma once

#include <functional>
#include <string>
#include <utility>

#include "nodes/graph/node.h"

namespace turnlight::nodes {

inline std::string FaultLine(const graph::Fault& fault) {
  return fault.node + ": " + fault.code + ": " + fault.text;
}

class LoggerNode : public graph::Node {
 public:
  // Called on the node's thread; must not throw.
  using Sink = std::function<void(const std::string& line)>;
  explicit LoggerNode(Sink sink) : sink_(std::move(sink)) {}

 private:
  Status OnFault(const graph::Message<graph::Fault>& fault) {
    sink_(FaultLine(*fault));
    return {};
  }

  graph::Input<graph::Fault> faults_{this, "faults", &LoggerNode::OnFault, graph::Need::kRequired,
                                     graph::Writers::kMany};
  Sink sink_;
};

}  // namespace turnlight::nodes
