#include "app/run_config.h"

#include <algorithm>
#include <memory>
#include <set>
#include <utility>

#include "app/rig_config.h"
#include "base/file.h"
#include "base/nearest.h"
#include "base/sha256.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxFileBytes = std::uint64_t{16} << 20;

bool HasRunKeys(const Document& document) {
  const nlohmann::json& root = document.root;
  return root.contains("capture") || root.contains("rig") || root.contains("graph");
}

// One driver for both devices, the simulated scene within the camera: how configs were before
// devices were named apart.
Status RefuseOldShape(const std::string& file, StrictObject rig) {
  auto camera = rig.OptionalObject("camera");
  const bool old = rig.Has("driver") || rig.Has("faults") || (camera && camera->Has("scene"));
  if (!old) return {};
  return InputError(
      file +
      ": the section rig is of the old shape, with one driver for both devices and the simulated "
      "scene within the camera; allowed is each device with its driver, and beside rig what only "
      "a simulated world has:\n" +
      kRigExample +
      "configs/simulated_turntable.yaml is a whole one. A run that was begun with the old shape "
      "is resumed and replayed by the version of turnlight that began it; its session, if "
      "complete, is estimated by turnlight estimate.");
}

constexpr char kByHand[] = "handheld_keyframes";

std::ptrdiff_t CountNodes(const nodes::graph::GraphConfig& graph, const std::string& type) {
  return std::count_if(graph.nodes.begin(), graph.nodes.end(),
                       [&](const auto& node) { return node.type == type; });
}

// Exactly one node takes the frames, and one keeps them; without a table none moves it.
Status RequireNodes(const nodes::graph::GraphConfig& graph) {
  const bool by_hand = CountNodes(graph, kByHand) > 0;
  for (const auto& [type, allowed] : {std::pair(by_hand ? kByHand : "keyframes", 1),
                                      {by_hand ? "keyframes" : kByHand, 0},
                                      {"turntable", by_hand ? 0 : 1},
                                      {"recorder", 1}}) {
    const std::ptrdiff_t count = CountNodes(graph, type);
    if (count != allowed)
      return InputError(StrictObject(*graph.document).Object("graph").Where("nodes") + ": " +
                        std::to_string(count) + " nodes of type " + type + ", allowed is exactly " +
                        std::to_string(allowed) + (by_hand ? std::string(" with ") + kByHand : ""));
  }
  return {};
}

// Of a capture that goes on until the lights are known: who knows them, who is told, and without a
// loss.
Status RequireVerdicts(const nodes::graph::GraphConfig& graph, const rig::CapturePlan& plan) {
  if (!plan.until) return {};
  const StrictObject section = StrictObject(*graph.document).Object("graph");
  const auto name_of = [&](const std::string& type) {
    const auto node = std::find_if(graph.nodes.begin(), graph.nodes.end(),
                                   [&](const auto& n) { return n.type == type; });
    return node->name;
  };
  if (const std::ptrdiff_t count = CountNodes(graph, "estimator"); count != 1)
    return InputError(section.Where("nodes") + ": " + std::to_string(count) +
                      " nodes of type estimator, allowed with capture/until is exactly 1");
  const std::string from = name_of("estimator") + ".verdict";
  for (const char* type : {"keyframes", "recorder"}) {
    const std::string to = name_of(type) + ".verdict";
    const bool there = std::any_of(graph.connections.begin(), graph.connections.end(),
                                   [&](const auto& c) { return c.from == from && c.to == to; });
    if (!there)
      return InputError(section.Where("connections") + ": capture/until needs {from: " + from +
                        ", to: " + to + ", policy: {keep_last: 1}}, which is missing");
  }
  return {};
}

// A log is good for the same capture, rig, simulation and graph; a hash of each, so that a refusal
// can name which of them differs. The rig is what its section says and the files that it names.
std::string HashOf(const Document& document, const std::string& rig_files,
                   const std::string& graph_hash) {
  const auto text = [&document](const char* key) {
    return document.root.value(key, nlohmann::json()).dump();
  };
  return "capture " + Sha256Hex(text("capture")) + " rig " + Sha256Hex(text("rig") + rig_files) +
         " simulation " + Sha256Hex(text("simulation")) + " graph " + graph_hash;
}

Status ReadPlan(const std::optional<StrictObject>& capture, rig::CapturePlan& into) {
  if (!capture) return {};
  auto plan = into.by_hand ? rig::ParsePlanByHand(*capture) : rig::ParseCapturePlan(*capture);
  if (!plan) return Forward(plan);
  into = std::move(*plan);
  return {};
}

Status ReadWorld(const std::optional<StrictObject>& simulation, RunConfig& config) {
  if (!simulation) return {};
  config.simulation_where = simulation->Where("");
  auto read = rig::sim::ReadSimulation(*simulation, AnglesOf(config.plan));
  if (!read) return Forward(read);
  config.simulation = std::move(*read);
  return {};
}

// A rig alone, without a misspelt graph either.
bool LacksAGraph(const nlohmann::json& root) {
  if (!root.is_object() || !root.contains("rig") || root.contains("graph")) return false;
  return std::none_of(root.items().begin(), root.items().end(), [](const auto& entry) {
    return !Nearest(entry.key(), std::vector<std::string>{"graph"}).empty();
  });
}

}  // namespace

rig::sim::KeyframeAngles AnglesOf(const rig::CapturePlan& plan) {
  if (plan.by_hand) return {0.0, 0.0, 1};
  const double sign = plan.direction == rig::TurnDirection::kCcw ? 1.0 : -1.0;
  return {plan.start_deg, sign * plan.step_deg, static_cast<int>(plan.count)};
}

Result<RunConfig> ParseRunConfig(const std::string& text, const std::string& file,
                                 const fs::path& origin) {
  auto parsed = ParseYaml(text, file);
  if (!parsed) return Forward(parsed);
  const auto document = std::make_shared<const Document>(std::move(*parsed));
  if (document->root.is_object() && document->root.contains("target") && !HasRunKeys(*document))
    return InputError(file +
                      ": a config for turnlight synthesize, allowed is one for turnlight run, " +
                      "with rig and graph");
  if (LacksAGraph(document->root))
    return InputError(file +
                      ": graph: this key is missing; home, jog, snap and doctor do without it, a "
                      "run needs it: the section graph of configs/simulated_turntable.yaml will do "
                      "for most rigs");
  StrictObject root(*document);
  const auto name = root.OptionalString("name");
  const auto capture = root.OptionalObject("capture");
  const StrictObject rig = root.Object("rig");
  const auto simulation = root.OptionalObject("simulation");
  auto graph = nodes::graph::ReadGraphConfig(document, root);
  if (const Status status = root.Finish(); !status) return Forward(status);
  if (const Status status = RefuseOldShape(file, rig); !status) return Forward(status);
  if (!graph) return Forward(graph);

  RunConfig config(rig, std::move(*graph));
  config.file = file;
  config.text = text;
  config.name = name.value_or(origin.stem().string());
  config.plan.by_hand = CountNodes(config.graph, kByHand) > 0;
  Status status = RequireNodes(config.graph);
  if (status) status = ReadPlan(capture, config.plan);
  if (status) status = RequireVerdicts(config.graph, config.plan);
  if (!status) return Forward(status);
  const auto files = ReadRigSection(origin.parent_path(), config);
  if (!files) return Forward(files);
  if (status = ReadWorld(simulation, config); !status) return Forward(status);
  config.calibration_text = files->calibration;
  config.graph.hash = HashOf(*document, files->calibration + files->mesh, config.graph.hash);
  return config;
}

Result<RunConfig> ReadRunConfig(const fs::path& path, const fs::path& origin) {
  const auto text = ReadTypedFile(path, kMaxFileBytes);
  if (!text) return Forward(text);
  return ParseRunConfig(*text, path.string(), origin);
}

Result<RunConfig> ReadRunConfig(const fs::path& path) { return ReadRunConfig(path, path); }

Result<bool> IsRunConfig(const fs::path& path) {
  const auto text = ReadTypedFile(path, kMaxFileBytes);
  if (!text) return Forward(text);
  const auto document = ParseYaml(*text, path.string());
  if (!document) return Forward(document);
  return document->root.is_object() && HasRunKeys(*document);
}

bool RemoveNodes(nodes::graph::GraphConfig& graph, const std::string& type) {
  std::set<std::string> removed;
  for (const nodes::graph::NodeConfig& node : graph.nodes)
    if (node.type == type) removed.insert(node.name);
  const auto of_removed = [&](const std::string& topic) {
    return removed.count(topic.substr(0, topic.find('.'))) > 0;
  };
  std::erase_if(graph.nodes, [&](const auto& node) { return removed.count(node.name) > 0; });
  std::erase_if(graph.connections, [&](const auto& connection) {
    return of_removed(connection.from) || of_removed(connection.to);
  });
  std::erase_if(graph.record, [&](const auto& record) { return of_removed(record.topic); });
  return !removed.empty();
}

}  // namespace turnlight::app
