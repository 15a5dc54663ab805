// A graph: nodes of registered types, connected as a config says, run once by an executor.
//   auto config = LoadGraphConfig("graph.yaml");
//   auto graph = Graph::Build(*config, registry);
//   auto report = graph->Run({.log = "run.log"});
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "nodes/graph/config.h"
#include "nodes/graph/core.h"
#include "nodes/graph/registry.h"

namespace turnlight::nodes::graph {

// What a built graph consists of; shared with the executor that runs it.
struct GraphParts {
  GraphConfig config;
  std::vector<std::unique_ptr<Node>> nodes;  // in order of declaration
  std::vector<std::unique_ptr<Connection>> connections;
  std::vector<OutputPort*> recorded;  // in order of the config
  std::atomic<int> stop_level{0};     // 0 run, 1 kDrain, 2 kNow
  bool configured = false;
  bool ran = false;

  NodeCore& core(std::size_t index) { return nodes[index]->core(); }
};

enum class StopCause {
  kCompleted,  // nothing was left to do
  kRequested,  // a node or the caller asked for a stop in order
  kImmediate,  // the caller asked to stop now
  kFault,      // a fault that cannot be recovered from
};

struct Overrun {
  std::string node;
  Duration took{};  // so far, when it was found
  Duration deadline{};
};

struct ConnectionReport {
  std::string from;
  std::string to;
  std::uint64_t delivered = 0;
  std::uint64_t dropped = 0;
  std::uint64_t blocked = 0;
  std::uint64_t discarded = 0;
};

struct ActionReport {
  std::string end;  // NODE.ACTION
  std::uint64_t late = 0;
  std::uint64_t duplicate = 0;
};

struct RunReport {
  StopCause cause = StopCause::kCompleted;
  Time ended_at{};
  std::vector<Fault> faults;  // in the order in which they came, the first 1000
  std::uint64_t fault_count = 0;
  std::optional<Fault> failure;   // the first that could not be recovered from
  std::vector<Overrun> overruns;  // handlers that took longer than their node's deadline_ms
  std::vector<std::string>
      hung;  // nodes whose handler did not return; their threads were left behind
  std::vector<ConnectionReport> connections;
  std::vector<ActionReport> actions;
  std::uint64_t handled = 0;  // messages and timers
};

struct RunOptions {
  // Where the topics under "record" go; empty: nowhere. The file must not exist yet.
  std::filesystem::path log = {};
  // Called with every fault as it comes, one at a time, on the thread where it arose; must not
  // throw.
  std::function<void(const Fault&)> on_fault = nullptr;
  // Wall executor: how long a handler may still take after a stop now before it counts as hung.
  Duration hang_grace = std::chrono::seconds(5);
};

class Graph {
 public:
  // Creates the nodes and connects them; nothing is opened. Fails (kInput), naming file and line,
  // on an unknown type, node or port, a wrong direction or message type, a second writer, a
  // required input without a connection, a cycle of nothing but block, an unknown topic under
  // "record".
  static Result<Graph> Build(GraphConfig config, const NodeRegistry& registry);

  // Hands every node its params. Run does it if it was not done.
  Status Configure();

  // Runs to the end, once. An Error is about the set-up (params, the log's file); what happens
  // while it runs is in the report.
  Result<RunReport> Run(const RunOptions& options = {});

  // The same with the sources replaced by what they published in a log, in virtual time whatever
  // the config says. Fails (kInput) if the log is of another config, or lacks a source's connected
  // topic.
  Result<RunReport> Replay(const std::filesystem::path& log, const RunOptions& options = {});

  // From any thread and from a signal handler. A second call may make the stop more urgent.
  void RequestStop(StopMode mode) { RaiseStop(*parts_, mode); }
  static void RaiseStop(GraphParts& parts, StopMode mode);

  // Calls tap with every message of the topic (NODE.PORT) from now on, and at once with the last
  // one of a latched topic. Before or while the graph runs; on the publisher's thread: be brief, do
  // not throw.
  template <typename T>
  Status Tap(const std::string& topic, std::function<void(const Message<T>&)> tap) {
    auto port = FindOutput(topic);
    if (!port) return Forward(port);
    if (&(*port)->type != &TypeOf<T>())
      return InputError(topic + ": carries " + ShowType((*port)->type) + ", the tap takes " +
                        ShowType(TypeOf<T>()));
    AddTap(**port, [tap = std::move(tap)](const AnyMessage& message) {
      tap(Typed<T>(AnyMessage(message)));
    });
    return {};
  }

  // Fails (kInput) with the topics there are.
  Result<OutputPort*> FindOutput(const std::string& topic) const;
  const GraphParts& parts() const { return *parts_; }

 private:
  explicit Graph(std::shared_ptr<GraphParts> parts) : parts_(std::move(parts)) {}
  Status ConfigureNodes(bool sources_too);

  std::shared_ptr<GraphParts> parts_;
};

}  // namespace turnlight::nodes::graph
