#include "nodes/graph/connect.h"

#include <map>
#include <set>
#include <utility>

#include "base/format.h"
#include "base/nearest.h"

namespace turnlight::nodes::graph {
namespace {

// Deep enough for a burst, and never blocking: only one goal is outstanding at a time.
constexpr Policy kActionPolicy{Policy::Kind::kKeepLast, 8};
constexpr Policy kFeedbackPolicy{Policy::Kind::kKeepLast, 1};

std::string Quoted(const std::string& text) { return "\"" + text + "\""; }

std::string List(const std::vector<std::string>& names) {
  return names.empty() ? "none" : Listed(names);
}

// "WHERE: "WORD": PROBLEM, allowed are A, B (did you mean "A"?)".
tl::unexpected<Error> Unknown(const std::string& where, const std::string& whole,
                              const std::string& word, const std::string& problem,
                              const std::vector<std::string>& allowed) {
  return InputError(where + ": " + Quoted(whole) + ": " + problem + ", allowed are " +
                    List(allowed) + DidYouMean(word, allowed));
}

template <typename Port>
Port* FindPort(const std::vector<Port*>& ports, const std::string& name) {
  for (Port* port : ports)
    if (port->name == name) return port;
  return nullptr;
}

ActionEnd* FindAction(const NodeCore& node, const std::string& name) {
  for (ActionEnd* action : node.actions)
    if (action->name == name) return action;
  return nullptr;
}

bool OfAction(const NodeCore& node, const InputPort& port) {
  for (const ActionEnd* action : node.actions)
    if (action->goal_in == &port || action->feedback_in == &port || action->result_in == &port)
      return true;
  return false;
}

class Wiring {
 public:
  explicit Wiring(GraphParts& parts) : parts_(parts) {
    for (std::size_t i = 0; i < parts.nodes.size(); ++i) {
      names_.push_back(parts.core(i).name);
      by_name_[names_.back()] = &parts.core(i);
    }
  }

  Status Run() {
    if (Status status = CheckNames(); !status) return status;
    for (const ConnectionConfig& connection : parts_.config.connections) {
      const Status status =
          connection.from.starts_with("*.") ? AddFromAll(connection) : AddOne(connection);
      if (!status) return status;
    }
    if (Status status = CheckComplete(); !status) return status;
    if (Status status = CheckCycles(); !status) return status;
    return AddRecords();
  }

 private:
  struct End {
    NodeCore* node = nullptr;
    std::string port;
  };

  Result<End> Split(const std::string& topic, const std::string& where) const {
    const std::size_t dot = topic.find('.');
    if (dot == std::string::npos || dot == 0 || dot + 1 == topic.size())
      return InputError(where + ": " + Quoted(topic) + ", allowed is NODE.PORT");
    const std::string name = topic.substr(0, dot);
    const auto found = by_name_.find(name);
    if (found == by_name_.end())
      return Unknown(where, topic, name, "there is no node " + Quoted(name), names_);
    return End{found->second, topic.substr(dot + 1)};
  }

  static std::vector<std::string> Sources(const NodeCore& node) {
    std::vector<std::string> names;
    for (const OutputPort* port : node.outputs) names.push_back(port->name);
    for (const ActionEnd* action : node.actions)
      if (action->is_client()) names.push_back(action->name);
    return names;
  }
  static std::vector<std::string> Targets(const NodeCore& node) {
    std::vector<std::string> names;
    for (const InputPort* port : node.inputs)
      if (!OfAction(node, *port)) names.push_back(port->name);
    for (const ActionEnd* action : node.actions)
      if (!action->is_client()) names.push_back(action->name);
    return names;
  }

  // Mistakes of whoever wrote the nodes, not of the config.
  Status CheckNames() const {
    std::map<std::string, const MessageType*> types;
    const auto clash = [&types](const MessageType& type) {
      return types.emplace(type.name, &type).first->second != &type;
    };
    for (const NodeConfig& config : parts_.config.nodes) {
      const NodeCore& node = *by_name_.at(config.name);
      std::set<std::string> ports;
      const std::string here = config.where + ": the node type " + Quoted(node.type);
      for (const OutputPort* port : node.outputs) {
        if (!ports.insert(port->name).second)
          return InputError(here + " declares the port " + Quoted(port->name) + " twice");
        if (clash(port->type))
          return InputError(here + " uses a second message type named " + Quoted(port->type.name));
      }
      for (const InputPort* port : node.inputs) {
        if (!ports.insert(port->name).second)
          return InputError(here + " declares the port " + Quoted(port->name) + " twice");
        if (clash(port->type))
          return InputError(here + " uses a second message type named " + Quoted(port->type.name));
      }
    }
    return {};
  }

  Status AddOne(const ConnectionConfig& connection) {
    const auto from = Split(connection.from, connection.from_where);
    if (!from) return Forward(from);
    const auto to = Split(connection.to, connection.to_where);
    if (!to) return Forward(to);
    ActionEnd* client = FindAction(*from->node, from->port);
    ActionEnd* server = FindAction(*to->node, to->port);
    OutputPort* output = FindPort(from->node->outputs, from->port);
    InputPort* input = FindPort(to->node->inputs, to->port);
    if (input && OfAction(*to->node, *input)) input = nullptr;
    if (!output && !(client && client->is_client()))
      return Unknown(
          connection.from_where, connection.from, from->port,
          from->node->name + " (" + from->node->type + ") has no output " + Quoted(from->port),
          Sources(*from->node));
    if (!input && !(server && !server->is_client()))
      return Unknown(connection.to_where, connection.to, to->port,
                     to->node->name + " (" + to->node->type + ") has no input " + Quoted(to->port),
                     Targets(*to->node));
    if (output && input) return AddTopic(connection, *output, *input);
    if (!output && !input) return AddAction(connection, *client, *server);
    return InputError(connection.to_where + ": " + connection.from + " is " +
                      (output ? "a topic" : "an action") + " and " + connection.to + " is " +
                      (input ? "a topic" : "an action") +
                      ", allowed is a topic to a topic or an action's client to its server");
  }

  // "*.fault" -> every other node's port of that name.
  Status AddFromAll(const ConnectionConfig& connection) {
    const auto to = Split(connection.to, connection.to_where);
    if (!to) return Forward(to);
    bool any = false;
    for (const std::string& name : names_) {
      if (name == to->node->name) continue;
      if (!FindPort(by_name_[name]->outputs, connection.from.substr(2))) continue;
      ConnectionConfig one = connection;
      one.from = name + connection.from.substr(1);
      if (Status status = AddOne(one); !status) return status;
      any = true;
    }
    if (any) return {};
    return InputError(connection.from_where + ": " + Quoted(connection.from) +
                      ": no other node has such an output, allowed is *.PORT of at least one");
  }

  Status AddTopic(const ConnectionConfig& connection, OutputPort& from, InputPort& to) {
    if (&from.type != &to.type)
      return InputError(connection.to_where + ": " + connection.from + " carries " +
                        ShowType(from.type) + ", allowed at " + connection.to + " is " +
                        ShowType(to.type));
    if (!connection.policy)
      return InputError(connection.policy_where +
                        ": missing, allowed is block or {keep_last: N} with N from 1 to 65536");
    if (from.name == "fault" && connection.policy->block())
      return InputError(
          connection.policy_where +
          ": block, allowed from a port \"fault\" is {keep_last: N}: reporting a fault "
          "must not wait");
    if (!to.many && !to.connections.empty())
      return InputError(connection.to_where + ": " + connection.to +
                        " has a second writer, allowed is one; the first is " +
                        to.connections[0]->from.Topic() + " at " + to.connections[0]->where);
    for (const Connection* other : to.connections)
      if (&other->from == &from)
        return InputError(connection.to_where + ": " + connection.from + " to " + connection.to +
                          " is connected twice, first at " + other->where);
    Join(from, to, *connection.policy, connection.from_where);
    return {};
  }

  Status AddAction(const ConnectionConfig& connection, ActionEnd& client, ActionEnd& server) {
    if (&client.goal_out->type != &server.goal_in->type ||
        &client.feedback_in->type != &server.feedback_out->type ||
        &client.result_in->type != &server.result_out->type)
      return InputError(connection.to_where + ": " + connection.from + " asks with " +
                        ShowType(client.goal_out->type) + " for " +
                        ShowType(client.result_in->type) + ", allowed at " + connection.to +
                        " is " + ShowType(server.goal_in->type) + " for " +
                        ShowType(server.result_out->type));
    if (connection.policy)
      return InputError(connection.policy_where +
                        ": an action has no policy, allowed is none: its queues never block");
    if (!client.goal_out->connections.empty())
      return InputError(connection.from_where + ": " + connection.from +
                        " has a second server, allowed is one; the first is at " +
                        client.goal_out->connections[0]->where);
    if (!server.goal_in->connections.empty())
      return InputError(connection.to_where + ": " + connection.to +
                        " has a second client, allowed is one; the first is " +
                        server.goal_in->connections[0]->from.node.name + " at " +
                        server.goal_in->connections[0]->where);
    Join(*client.goal_out, *server.goal_in, kActionPolicy, connection.from_where);
    Join(*server.feedback_out, *client.feedback_in, kFeedbackPolicy, connection.from_where);
    Join(*server.result_out, *client.result_in, kActionPolicy, connection.from_where);
    return {};
  }

  void Join(OutputPort& from, InputPort& to, Policy policy, const std::string& where) {
    auto connection = std::make_unique<Connection>(from, to, policy, where);
    from.connections.push_back(connection.get());
    to.connections.push_back(connection.get());
    to.node.incoming.push_back(connection.get());
    parts_.connections.push_back(std::move(connection));
  }

  Status CheckComplete() const {
    for (const NodeConfig& config : parts_.config.nodes) {
      const NodeCore& node = *by_name_.at(config.name);
      for (const InputPort* port : node.inputs)
        if (port->required && port->connections.empty())
          return InputError(config.where + ": the input " + port->Topic() + " (" +
                            ShowType(port->type) + ") has no connection, allowed is one; " +
                            Offers(port->type));
      for (const ActionEnd* action : node.actions)
        if (action->is_client() && action->goal_out->connections.empty())
          return InputError(config.where + ": the action " + node.name + "." + action->name +
                            " has no server, allowed is one");
    }
    return {};
  }

  // "outputs of that type are a.b, c.d".
  std::string Offers(const MessageType& type) const {
    std::vector<std::string> topics;
    for (const auto& node : parts_.nodes)
      for (const OutputPort* port : node->core().outputs)
        if (&port->type == &type) topics.push_back(port->Topic());
    return "outputs of that type: " + List(topics);
  }

  // A ring of full queues, each waiting for the next, would stand still for ever.
  Status CheckCycles() {
    for (const auto& node : parts_.nodes) {
      std::vector<const Connection*> path;
      std::set<const NodeCore*> done;
      if (!BlocksItself(node->core(), node->core(), done, path)) continue;
      std::string ring = node->core().name;
      for (const Connection* edge : path) ring += " -> " + edge->to.node.name;
      return InputError(path.front()->where + ": the cycle " + ring +
                        " has the policy block on every connection and can stand still for ever, "
                        "allowed is a cycle with {keep_last: N} on at least one");
    }
    return {};
  }
  static bool BlocksItself(const NodeCore& start, const NodeCore& at,
                           std::set<const NodeCore*>& done, std::vector<const Connection*>& path) {
    for (const OutputPort* port : at.outputs)
      for (const Connection* edge : port->connections) {
        if (!edge->queue.policy().block()) continue;
        path.push_back(edge);
        if (&edge->to.node == &start) return true;
        if (done.insert(&edge->to.node).second && BlocksItself(start, edge->to.node, done, path))
          return true;
        path.pop_back();
      }
    return false;
  }

  Status AddRecords() {
    for (const RecordConfig& record : parts_.config.record) {
      if (record.topic.starts_with("*.")) {
        for (const std::string& name : names_)
          if (OutputPort* port = FindPort(by_name_[name]->outputs, record.topic.substr(2)))
            if (Status status = AddRecord(record, *port); !status) return status;
        continue;
      }
      const auto end = Split(record.topic, record.where);
      if (!end) return Forward(end);
      std::vector<std::string> names;
      for (const OutputPort* output : end->node->outputs) names.push_back(output->name);
      OutputPort* port = FindPort(end->node->outputs, end->port);
      if (!port)
        return Unknown(
            record.where, record.topic, end->port,
            end->node->name + " (" + end->node->type + ") has no output " + Quoted(end->port),
            names);
      if (Status status = AddRecord(record, *port); !status) return status;
    }
    return {};
  }
  Status AddRecord(const RecordConfig& record, OutputPort& port) {
    for (const OutputPort* other : parts_.recorded)
      if (other == &port)
        return InputError(record.where + ": " + Quoted(port.Topic()) +
                          " stands here twice, allowed is once");
    parts_.recorded.push_back(&port);
    return {};
  }

  GraphParts& parts_;
  std::vector<std::string> names_;  // in order of declaration
  std::map<std::string, NodeCore*> by_name_;
};

}  // namespace

Status Connect(GraphParts& parts) { return Wiring(parts).Run(); }

}  // namespace turnlight::nodes::graph
