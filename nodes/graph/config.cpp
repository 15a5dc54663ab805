#include "nodes/graph/config.h"

#include <algorithm>
#include <cctype>
#include <utility>

#include "base/file.h"
#include "base/sha256.h"

namespace turnlight::nodes::graph {
namespace {

using nlohmann::json;

constexpr std::int64_t kMaxCapacity = 65536;
constexpr std::size_t kDefaultCapacity = 8;

bool IsName(const std::string& name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-';
  });
}

// The keys of an object in the order of the file: JSON objects sort them, the lines tell.
std::vector<std::string> KeysInOrder(const Document& document, const json& object,
                                     const std::string& pointer) {
  std::vector<std::pair<int, std::string>> keys;
  for (const auto& entry : object.items()) {
    const auto line = document.lines.find(pointer + "/" + entry.key());
    keys.emplace_back(line == document.lines.end() ? 0 : line->second, entry.key());
  }
  std::sort(keys.begin(), keys.end());
  std::vector<std::string> names;
  for (auto& key : keys) names.push_back(std::move(key.second));
  return names;
}

Result<NodeConfig> ReadNode(const Document& document, StrictObject& nodes,
                            const std::string& name) {
  static const json kNoParams = json::object();
  if (!IsName(name))
    return InputError(nodes.Where(name) + ": \"" + name +
                      "\", allowed in a node's name are letters, digits, _ and -");
  StrictObject node = nodes.Object(name);
  const std::string where = nodes.Where(name);
  const std::string type = node.String("type");
  const double duration_ms = node.OptionalNumber("duration_ms", {.min = 0, .max = 1e9}).value_or(0);
  const auto deadline_ms = node.OptionalNumber("deadline_ms", {.max = 1e9, .above = 0});
  auto params = node.OptionalObject("params");
  if (Status status = node.Finish(); !status) return Forward(status);
  if (!params) params = StrictObject(document, kNoParams, "/graph/nodes/" + name + "/params");
  if (!params->ok()) return Forward(params->Finish());
  std::optional<Duration> deadline;
  if (deadline_ms) deadline = FromMs(*deadline_ms);
  return NodeConfig{name,     type, *params, std::max(FromMs(duration_ms), Duration(1)),
                    deadline, where};
}

// block, or {keep_last: n}.
std::optional<Policy> ReadPolicy(StrictObject& connection) {
  constexpr const char* kAllowed = "block or {keep_last: N} with N from 1 to 65536";
  const json& policy = connection.Raw("policy");
  const auto capacity = connection.OptionalInteger("capacity", 1, kMaxCapacity);
  if (!connection.Has("policy")) return std::nullopt;
  if (policy == "block")
    return Policy{Policy::Kind::kBlock,
                  capacity ? static_cast<std::size_t>(*capacity) : kDefaultCapacity};
  if (!policy.is_object()) {
    connection.Refuse("policy", kAllowed);
    return std::nullopt;
  }
  if (capacity) connection.RefuseText("capacity", "the capacity of keep_last is its number");
  StrictObject keep = connection.Object("policy");
  const auto count = keep.Integer("keep_last", 1, kMaxCapacity);
  if (Status status = keep.Finish(); !status) connection.Refuse("policy", kAllowed);
  return Policy{Policy::Kind::kKeepLast, static_cast<std::size_t>(count)};
}

Result<ConnectionConfig> ReadConnection(StrictObject& object) {
  ConnectionConfig connection;
  connection.from = object.String("from");
  connection.to = object.String("to");
  connection.policy = ReadPolicy(object);
  connection.from_where = object.Where("from");
  connection.to_where = object.Where("to");
  connection.policy_where = object.Where("policy");
  if (Status status = object.Finish(); !status) return Forward(status);
  // Not before a misspelt policy has been named.
  if (!connection.policy && object.Has("capacity"))
    return InputError(object.Where("capacity") + ": a capacity goes with policy: block");
  return connection;
}

void ReadRecord(StrictObject& object, GraphConfig& config) {
  const json& record = object.Raw("record");
  if (!object.Has("record")) return;
  if (!record.is_array()) return object.Refuse("record", "a list of topics, NODE.PORT");
  for (std::size_t i = 0; i < record.size(); ++i) {
    if (!record[i].is_string()) return object.Refuse("record", "a list of topics, NODE.PORT");
    config.record.push_back(
        {record[i].get<std::string>(), object.Where("record/" + std::to_string(i))});
  }
}

std::string HashOf(const json& section, const std::vector<NodeConfig>& nodes) {
  std::string text = section.dump();
  for (const NodeConfig& node : nodes) text += "\n" + node.name;  // their order matters
  return Sha256Hex(text);
}

}  // namespace

Result<GraphConfig> ReadGraphConfig(std::shared_ptr<const Document> document, StrictObject& root) {
  GraphConfig config;
  config.document = document;
  StrictObject object = root.Object("graph");
  if (!root.ok()) return Forward(root.Finish());
  config.executor = object.Choice("executor", {"virtual", "wall"}) == "wall"
                        ? ExecutorKind::kWall
                        : ExecutorKind::kVirtual;
  config.seed = static_cast<std::uint64_t>(
      object.OptionalInteger("seed", 0, std::numeric_limits<std::int64_t>::max()).value_or(0));
  const json& section = document->root["graph"];
  StrictObject nodes = object.Object("nodes");
  std::vector<StrictObject> connections;
  if (object.Has("connections")) connections = object.Objects("connections", 0);
  ReadRecord(object, config);
  if (Status status = object.Finish(); !status) return Forward(status);
  if (!nodes.ok()) return Forward(nodes.Finish());
  for (const std::string& name : KeysInOrder(*document, section["nodes"], "/graph/nodes")) {
    auto node = ReadNode(*document, nodes, name);
    if (!node) return Forward(node);
    config.nodes.push_back(std::move(*node));
  }
  if (Status status = nodes.Finish(); !status) return Forward(status);
  if (config.nodes.empty())
    return InputError(object.Where("nodes") + ": no node, allowed is at least one");
  for (StrictObject& item : connections) {
    auto connection = ReadConnection(item);
    if (!connection) return Forward(connection);
    config.connections.push_back(std::move(*connection));
  }
  config.hash = HashOf(section, config.nodes);
  return config;
}

Result<GraphConfig> ParseGraphConfig(const std::string& yaml, std::string file) {
  auto parsed = ParseYaml(yaml, std::move(file));
  if (!parsed) return Forward(parsed);
  const auto document = std::make_shared<const Document>(std::move(*parsed));
  StrictObject root(*document);
  root.AllowPrefix("x-");
  auto config = ReadGraphConfig(document, root);
  if (!config) return config;
  if (Status status = root.Finish(); !status) return Forward(status);
  return config;
}

Result<GraphConfig> LoadGraphConfig(const std::filesystem::path& path) {
  auto text = ReadFile(path, std::uint64_t{1} << 20);
  if (!text) return Forward(text);
  return ParseGraphConfig(*text, path.string());
}

}  // namespace turnlight::nodes::graph
