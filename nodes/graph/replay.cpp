#include "nodes/graph/replay.h"

namespace turnlight::nodes::graph {
namespace {

bool LeadsToRunningNode(const OutputPort& port) {
  for (const Connection* connection : port.connections)
    if (!connection->to.node.is_source) return true;
  return false;
}

// The source's port that each topic of the log belongs to; null for what running nodes published.
Result<std::vector<OutputPort*>> PortsOf(GraphParts& parts, const LogHeader& header,
                                         const std::string& name) {
  std::vector<OutputPort*> ports(header.topics.size(), nullptr);
  for (std::size_t n = 0; n < parts.nodes.size(); ++n) {
    if (!parts.core(n).is_source) continue;
    for (OutputPort* port : parts.core(n).outputs) {
      bool found = false;
      for (std::size_t i = 0; i < ports.size(); ++i) {
        const LogTopic& topic = header.topics[i];
        if (topic.topic != port->Topic()) continue;
        if (topic.type != port->type.name || topic.version != port->type.version)
          return InputError(name + ": " + topic.topic + " was recorded as " + topic.type + " v" +
                            std::to_string(topic.version) + ", allowed is " + ShowType(port->type));
        ports[i] = port;
        found = true;
      }
      if (!found && LeadsToRunningNode(*port))
        return InputError(name + ": " + port->Topic() +
                          " is not in the log; a run that is to be replayed must have it under "
                          "record");
    }
  }
  return ports;
}

}  // namespace

Result<ReplayPlan> PlanReplay(GraphParts& parts, LogReader& reader, const std::string& name) {
  const LogHeader& header = reader.header();
  if (header.config_hash != parts.config.hash)
    return InputError(name + ": recorded with the config of hash " + header.config_hash +
                      ", allowed is this one's, " + parts.config.hash);
  if (header.seed != parts.config.seed)
    return InputError(name + ": recorded with seed " + std::to_string(header.seed) +
                      ", allowed is " + std::to_string(parts.config.seed));
  auto ports = PortsOf(parts, header, name);
  if (!ports) return Forward(ports);
  ReplayPlan plan;
  plan.reader = &reader;
  plan.entries.resize(parts.nodes.size());
  while (const auto record = reader.Next()) {
    OutputPort* port = (*ports)[record->topic];
    if (port)
      plan.entries[port->node.index].push_back({record->header.processed_at, record->offset, port});
  }
  plan.stop = reader.tail().stop;
  return plan;
}

}  // namespace turnlight::nodes::graph
