#include "app/run_config.h"

#include <set>
#include <utility>

#include "base/file.h"
#include "base/sha256.h"
#include "nodes/capture_nodes.h"
#include "rig/sim/blob.h"

namespace turnlight::app {
namespace {

Status ReadRig(StrictObject rig, RunConfig& config) {
  rig.Choice("driver", {"mock"});
  auto table = rig.OptionalObject("table");
  auto camera = rig.OptionalObject("camera");
  auto faults = rig.OptionalObject("faults");
  if (Status status = rig.Finish(); !status) return status;
  if (table) {
    auto read = rig::ReadMockTurntableConfig(*table);
    if (!read) return Forward(read);
    config.table = *read;
  }
  if (camera) {
    auto read = rig::ReadMockCameraConfig(*camera);
    if (!read) return Forward(read);
    config.camera = *read;
  }
  if (!faults) return {};
  const rig::CapturePlan& plan = config.plan;
  const double sign = plan.direction == rig::TurnDirection::kCcw ? 1.0 : -1.0;
  auto read = rig::ReadFaultScript(
      *faults, {plan.start_deg, sign * plan.step_deg, static_cast<int>(plan.count)});
  if (!read) return Forward(read);
  config.faults = std::move(*read);
  return {};
}

bool HasRunKeys(const Document& document) {
  const nlohmann::json& root = document.root;
  return root.contains("capture") || root.contains("rig") || root.contains("graph");
}

// Exactly one node takes the frames, and one keeps them.
Status RequireNodes(const graph::GraphConfig& graph) {
  for (const std::string type : {"keyframes", "recorder"}) {
    const auto count = std::count_if(graph.nodes.begin(), graph.nodes.end(),
                                     [&](const auto& node) { return node.type == type; });
    if (count != 1)
      return InputError(StrictObject(*graph.document).Object("graph").Where("nodes") + ": " +
                        std::to_string(count) + " nodes of type " + type +
                        ", allowed is exactly 1");
  }
  return {};
}

// A log is good for the same capture, rig and graph; three hashes, so that a refusal can name which
// of them differs.
std::string HashOf(const Document& document, const std::string& graph_hash) {
  const auto hash = [&document](const char* key) {
    return Sha256Hex(document.root.value(key, nlohmann::json()).dump());
  };
  return "capture " + hash("capture") + " rig " + hash("rig") + " graph " + graph_hash;
}

rig::PictureFormat FormatOf(const rig::SyntheticConfig& scene) {
  rig::PictureFormat format;
  format.size = {scene.camera.width, scene.camera.height};
  format.channels = 3;
  format.depth = scene.sensor.depth == rig::SensorDepth::k8    ? CV_8U
                 : scene.sensor.depth == rig::SensorDepth::k16 ? CV_16U
                                                               : CV_32F;
  return format;
}

// The simulated sensor's noise in the merge's terms.
rig::SensorNoise NoiseOf(const rig::MockCamera& camera) {
  const rig::Sensor& sensor = camera.config().scene.sensor;
  const calib::Radiometry& radiometry = camera.studio().radiometry;
  const double span = radiometry.white - radiometry.black;
  rig::SensorNoise noise;
  noise.read_noise_dn = sensor.noise_relative * span;
  noise.dn_per_electron = sensor.noise_shot * sensor.noise_shot * span;
  return noise;
}

rig::CaptureTarget TargetOf(const calib::TargetShape& shape) {
  if (const auto* sphere = std::get_if<calib::SphereShape>(&shape)) return *sphere;
  if (const auto* plane = std::get_if<calib::PlaneShape>(&shape)) return *plane;
  return rig::MeshCopy{rig::MeshFormat::kPly, rig::MeshToPly(std::get<calib::MeshShape>(shape))};
}

}  // namespace

Result<RunConfig> ParseRunConfig(const std::string& text, const std::string& file) {
  auto parsed = ParseYaml(text, file);
  if (!parsed) return Forward(parsed);
  const auto document = std::make_shared<const Document>(std::move(*parsed));
  if (document->root.is_object() && document->root.contains("target") && !HasRunKeys(*document))
    return InputError(file +
                      ": a config for turnlight synthesize, allowed is one for turnlight run, " +
                      "with rig and graph");
  RunConfig config;
  config.file = file;
  config.text = text;
  StrictObject root(*document);
  config.name = root.OptionalString("name").value_or(std::filesystem::path(file).stem().string());
  const auto capture = root.OptionalObject("capture");
  const StrictObject rig = root.Object("rig");
  auto graph = graph::ReadGraphConfig(document, root);
  if (const Status status = root.Finish(); !status) return Forward(status);
  if (!graph) return Forward(graph);
  config.graph = std::move(*graph);
  config.graph.hash = HashOf(*document, config.graph.hash);
  if (capture) {
    auto plan = rig::ParseCapturePlan(*capture);
    if (!plan) return Forward(plan);
    config.plan = std::move(*plan);
  }
  if (const Status status = ReadRig(rig, config); !status) return Forward(status);
  return config;
}

Result<RunConfig> ReadRunConfig(const std::filesystem::path& path) {
  const auto text = ReadFile(path, std::uint64_t{16} << 20);
  if (!text) return Forward(text);
  return ParseRunConfig(*text, path.string());
}

Result<bool> IsRunConfig(const std::filesystem::path& path) {
  const auto text = ReadFile(path, std::uint64_t{16} << 20);
  if (!text) return Forward(text);
  const auto document = ParseYaml(*text, path.string());
  if (!document) return Forward(document);
  return document->root.is_object() && HasRunKeys(*document);
}

Result<Rig> MakeRig(const RunConfig& config) {
  Rig rig;
  rig.faults = std::make_shared<rig::FaultScript>(config.faults);
  rig.table = std::make_shared<rig::MockTurntable>(config.table, rig.faults);
  auto camera = rig::MockCamera::Create(config.camera, rig.table, rig.faults);
  if (!camera) return Forward(camera);
  rig.camera = std::move(*camera);
  rig.format = FormatOf(config.camera.scene);
  rig.noise = NoiseOf(*rig.camera);
  return rig;
}

Result<RigIdentity> OpenRig(const Rig& rig) {
  const auto camera = rig.camera->Open(rig::DeviceTime(0));
  if (!camera) return Forward(camera);
  const auto table = rig.table->Open(rig::DeviceTime(0));
  if (!table) return Forward(table);
  return RigIdentity{*camera, *table};
}

rig::CaptureSetup MakeCaptureSetup(const RunConfig& config, const Rig& rig,
                                   const RigIdentity& identity) {
  const rig::Studio& studio = rig.camera->studio();
  return {.plan = config.plan,
          .config_text = config.text,
          .name = config.name,
          .length_unit = "mm",
          .camera = studio.camera,
          .radiometry = studio.radiometry,
          .bayer = std::nullopt,
          .target = TargetOf(studio.target),
          .format = rig.format,
          .camera_identity = identity.camera,
          .table_identity = identity.table};
}

Result<graph::Graph> BuildGraph(const RunConfig& config, const Rig& rig, GraphUse use) {
  if (const Status status = RequireNodes(config.graph); !status) return Forward(status);
  const rig::Studio& studio = rig.camera->studio();
  nodes::KeyframesJob job;
  job.plan = config.plan;
  job.frames = std::move(use.frames);
  job.radiometry = studio.radiometry;
  auto graph = graph::Graph::Build(
      config.graph,
      nodes::CaptureNodes({rig.table, rig.camera, std::move(job), studio.camera, rig.noise,
                           [camera = rig.camera](double angle_deg) {
                             const rig::Placement placed = camera->PlacementAt(angle_deg);
                             return nodes::CameraAndTarget{placed.X_WC, placed.X_WT};
                           },
                           studio.target, std::move(use.recorder), std::move(use.log_line)}));
  if (!graph) return graph;
  if (const Status status = graph->Configure(); !status) return Forward(status);
  return graph;
}

void RemoveNodes(graph::GraphConfig& graph, const std::string& type) {
  std::set<std::string> removed;
  for (const graph::NodeConfig& node : graph.nodes)
    if (node.type == type) removed.insert(node.name);
  const auto of_removed = [&](const std::string& topic) {
    return removed.count(topic.substr(0, topic.find('.'))) > 0;
  };
  std::erase_if(graph.nodes, [&](const auto& node) { return removed.count(node.name) > 0; });
  std::erase_if(graph.connections, [&](const auto& connection) {
    return of_removed(connection.from) || of_removed(connection.to);
  });
  std::erase_if(graph.record, [&](const auto& record) { return of_removed(record.topic); });
}

}  // namespace turnlight::app
