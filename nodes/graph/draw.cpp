#include "nodes/graph/draw.h"

#include <algorithm>
#include <cstdio>

namespace turnlight::nodes::graph {
namespace {

std::string ShowPolicy(const Policy& policy) {
  return (policy.block() ? "block " : "keep_last ") + std::to_string(policy.capacity);
}

std::string ShowMs(Duration duration) {
  char text[40];
  std::snprintf(text, sizeof text, "%g ms", ToMs(duration));
  return text;
}

std::string Padded(std::string text, std::size_t width) {
  text.resize(std::max(width, text.size()), ' ');
  return text;
}

bool IsRecorded(const GraphParts& parts, const OutputPort& port) {
  return std::find(parts.recorded.begin(), parts.recorded.end(), &port) != parts.recorded.end();
}

bool OfAction(const NodeCore& node, const void* port) {
  return std::any_of(node.actions.begin(), node.actions.end(), [port](const ActionEnd* action) {
    return port == action->goal_out || port == action->goal_in || port == action->feedback_out ||
           port == action->feedback_in || port == action->result_out || port == action->result_in;
  });
}

// The port "fault" is on every node: shown only where it leads somewhere.
bool IsShown(const GraphParts& parts, const NodeCore& node, const OutputPort& port) {
  return (!OfAction(node, &port) && port.name != "fault") || !port.connections.empty() ||
         port.tapped || IsRecorded(parts, port);
}

std::string Title(const NodeCore& node) {
  std::string text = node.name + "  (" + node.type + ")";
  if (node.is_source) text += "  source";
  if (node.duration > Duration(1)) text += "  takes " + ShowMs(node.duration);
  if (node.deadline) text += "  deadline " + ShowMs(*node.deadline);
  return text + "\n";
}

std::string InputLines(const NodeCore& node, std::size_t width) {
  std::string text;
  for (const InputPort* port : node.inputs) {
    if (OfAction(node, port)) continue;
    const std::string front =
        "  <- " + Padded(port->name, width) + "  " + Padded(ShowType(port->type), width) + "  ";
    if (port->connections.empty()) text += front + "not connected\n";
    for (const Connection* connection : port->connections)
      text += front + "from " + connection->from.Topic() + ", " +
              ShowPolicy(connection->queue.policy()) + "\n";
  }
  return text;
}

std::string OutputLines(const GraphParts& parts, const NodeCore& node, std::size_t width) {
  std::string text;
  for (const OutputPort* port : node.outputs) {
    if (!IsShown(parts, node, *port) || OfAction(node, port)) continue;
    text += "  -> " + Padded(port->name, width) + "  " + Padded(ShowType(port->type), width);
    if (port->latched) text += "  latched";
    if (IsRecorded(parts, *port)) text += "  recorded";
    text += "\n";
  }
  return text;
}

std::string ActionLines(const NodeCore& node, std::size_t width) {
  std::string text;
  for (const ActionEnd* action : node.actions) {
    if (!action->is_client()) {
      text += "  => " + Padded(action->name, width) + "  serves " +
              ShowType(action->goal_in->type) + "\n";
      continue;
    }
    const auto& to = action->goal_out->connections;
    text += "  => " + Padded(action->name, width) + "  asks " +
            (to.empty() ? "nobody" : to[0]->to.node.name) + " with " +
            ShowType(action->goal_out->type) + "\n";
  }
  return text;
}

std::string DotQuoted(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c == '\n' ? "\\n" : std::string(1, c);
  }
  return quoted + "\"";
}

}  // namespace

std::string DrawText(const GraphParts& parts) {
  std::string text =
      std::string(parts.config.executor == ExecutorKind::kWall ? "wall" : "virtual") +
      " executor, seed " + std::to_string(parts.config.seed) + ", config " +
      parts.config.hash.substr(0, 12) + "\n";
  std::size_t width = 8;
  for (const auto& node : parts.nodes) {
    for (const OutputPort* port : node->core().outputs)
      if (!OfAction(node->core(), port)) width = std::max(width, port->name.size());
    for (const InputPort* port : node->core().inputs)
      if (!OfAction(node->core(), port)) width = std::max(width, port->name.size());
  }
  for (const auto& node : parts.nodes) {
    const NodeCore& core = node->core();
    text += "\n" + Title(core) + InputLines(core, width) + OutputLines(parts, core, width) +
            ActionLines(core, width);
  }
  return text;
}

std::string DrawDot(const GraphParts& parts) {
  std::string text = "digraph turnlight {\n  rankdir=LR;\n  node [shape=ellipse];\n";
  for (const auto& node : parts.nodes) {
    const NodeCore& core = node->core();
    text += "  " + DotQuoted(core.name) + " [label=" + DotQuoted(core.name + "\n" + core.type) +
            (core.is_source ? ", shape=box" : "") + "];\n";
  }
  for (const auto& connection : parts.connections) {
    const NodeCore& from = connection->from.node;
    const NodeCore& to = connection->to.node;
    std::string style;
    std::string label = connection->from.name + "\n" + ShowPolicy(connection->queue.policy());
    if (OfAction(from, &connection->from)) {
      // One edge for the three topics of an action.
      if (!connection->from.name.ends_with(".goal")) continue;
      label = connection->from.name.substr(0, connection->from.name.size() - 5);
      style = ", style=dashed, arrowhead=diamond";
    }
    text += "  " + DotQuoted(from.name) + " -> " + DotQuoted(to.name) +
            " [label=" + DotQuoted(label) + style + "];\n";
  }
  return text + "}\n";
}

}  // namespace turnlight::nodes::graph
