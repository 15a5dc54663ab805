// The key "graph" of a config file, read strictly. What it means is checked when the graph is
// built.
//
//   graph:
//     executor: virtual            # or wall
//     seed: 7                      # optional, 0
//     nodes:                       # the order is the order of delivery at equal times, and of
//     stopping
//       counter: {type: counter, params: {count: 5, period_ms: 100}}
//       limit: {type: threshold, params: {limit: 2}, duration_ms: 0.5, deadline_ms: 50}
//     connections:
//       - {from: counter.number, to: limit.in, policy: block, capacity: 4}
//       - {from: limit.above, to: printer.in, policy: {keep_last: 1}}
//       - {from: "*.fault", to: logger.faults, policy: {keep_last: 16}}   # of every other node
//       - {from: commander.move, to: table.move}                          # an action has no policy
//     record: [counter.number, limit.above]
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "base/strict_object.h"
#include "nodes/graph/queue.h"
#include "nodes/graph/time.h"

namespace turnlight::nodes::graph {

enum class ExecutorKind { kVirtual, kWall };

struct NodeConfig {
  std::string name;  // letters, digits, _ and -
  std::string type;
  StrictObject params;
  Duration duration{1};              // duration_ms, at least 1 ns; virtual executor
  std::optional<Duration> deadline;  // deadline_ms, real time
  std::string where;                 // "FILE:LINE: KEY" of the node, for messages
};

struct ConnectionConfig {
  std::string from;  // NODE.PORT
  std::string to;
  std::optional<Policy> policy;  // none: an action
  std::string from_where;
  std::string to_where;
  std::string policy_where;
};

struct RecordConfig {
  std::string topic;  // NODE.PORT of an output
  std::string where;
};

struct GraphConfig {
  std::shared_ptr<const Document> document;  // params point into it
  ExecutorKind executor = ExecutorKind::kVirtual;
  std::uint64_t seed = 0;
  std::vector<NodeConfig> nodes;  // in the order of the file
  std::vector<ConnectionConfig> connections;
  std::vector<RecordConfig> record;
  // SHA-256 of what the graph section says, in a canonical form: comments and layout do not matter.
  std::string hash;
};

// Reads the key "graph" of root, which must be the root of document; other keys are left to the
// caller. Fails (kInput) with file, line, key and what is allowed.
Result<GraphConfig> ReadGraphConfig(std::shared_ptr<const Document> document, StrictObject& root);

// A YAML text with nothing but the key "graph" (and keys that begin with "x-"). file is for
// messages.
Result<GraphConfig> ParseGraphConfig(const std::string& yaml, std::string file);
Result<GraphConfig> LoadGraphConfig(const std::filesystem::path& path);

}  // namespace turnlight::nodes::graph
