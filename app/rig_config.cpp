#include "app/rig_config.h"

#include <utility>

#include "app/calibrate/camera_option.h"
#include "app/driver_choice.h"
#include "base/file.h"
#include "base/format.h"
#include "estimator/results/scene_json.h"
#include "nodes/capture_nodes.h"
#include "rig/session/mesh_file.h"
#include "rig/session/session_fields.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;

constexpr char kCalibrationIs[] = "the path of a rig-calibration.json, or an object with its keys";

Result<rig::RigTarget> ReadMeshTarget(const StrictObject& object, const fs::path& path) {
  auto bytes = ReadFile(path);
  if (!bytes) return InputError(object.Where("path") + ": " + bytes.error().text);
  auto shape = rig::ParseMesh(*bytes, path);
  if (!shape) return Forward(shape);
  const auto format = path.extension() == ".obj" ? rig::MeshFormat::kObj : rig::MeshFormat::kPly;
  return rig::RigTarget{std::move(*shape), rig::MeshCopy{format, std::move(*bytes)}};
}

Result<rig::RigTarget> ReadTarget(StrictObject object, const fs::path& folder) {
  const rig::Target target = rig::ReadTargetKeys(object);
  if (const Status status = object.Finish(); !status) return Forward(status);
  if (const auto* sphere = std::get_if<calib::SphereShape>(&target))
    return rig::RigTarget{*sphere, *sphere};
  if (const auto* plane = std::get_if<calib::PlaneShape>(&target))
    return rig::RigTarget{*plane, *plane};
  return ReadMeshTarget(object, folder / std::get<rig::MeshFile>(target).path);
}

// A driver of each device, and its keys. Without a table both are empty.
struct Chosen {
  const Driver<rig::TableDevice>* table;
  const Driver<rig::CameraDevice>* camera;
  std::optional<StrictObject> table_keys;
  StrictObject camera_keys;
};

Result<Chosen> Choose(const RunConfig& config, const Drivers& drivers) {
  Chosen chosen{nullptr, nullptr, config.table, config.camera};
  if (chosen.table_keys) chosen.table = FindDriver(drivers.tables, *chosen.table_keys);
  if (chosen.table_keys && !chosen.table) return Forward(chosen.table_keys->Finish());
  chosen.camera = FindDriver(drivers.cameras, chosen.camera_keys);
  if (!chosen.camera) return Forward(chosen.camera_keys.Finish());
  return chosen;
}

// All devices are simulated and in a world, or none is.
Status CheckWorld(const RunConfig& config, const Chosen& chosen) {
  const bool camera = chosen.camera->simulated();
  const bool table = chosen.table ? chosen.table->simulated() : camera;
  const std::string real = (table || !chosen.table ? "rig/camera/driver: " + chosen.camera->name
                                                   : "rig/table/driver: " + chosen.table->name);
  if (config.simulation && !(table && camera))
    return InputError(config.simulation_where + ": it stands beside " + real +
                      ", which is no simulated device; allowed is a simulation only where both "
                      "drivers are simulated, mock for example");
  if (table != camera)
    return InputError(config.rig.Where(table ? "table/driver" : "camera/driver") + ": " +
                      (table ? chosen.table->name : chosen.camera->name) +
                      ", a simulated device, beside " + real +
                      "; allowed are two simulated devices or two real ones");
  if (table && !config.simulation)
    return InputError(config.rig.Where(chosen.table ? "table/driver" : "camera/driver") + ": " +
                      chosen.camera->name + " needs the section simulation beside rig, as in\n" +
                      kRigExample);
  if (config.simulation && config.plan.by_hand != config.simulation->camera.walk.has_value())
    return InputError(config.simulation_where + "/walk: " +
                      (config.plan.by_hand ? "this key is missing, a camera that is carried by "
                                             "hand needs it"
                                           : "allowed is this section with the node "
                                             "handheld_keyframes, and without a table"));
  return {};
}

// What is known of a real rig has to be said.
Status RequireKnown(const RunConfig& config) {
  for (const auto& [key, there] :
       {std::pair("lens", config.lens.has_value()), {"radiometry", config.radiometry.has_value()}})
    if (config.plan.by_hand && !there)
      return InputError(config.rig.Where(key) +
                        ": this key is missing, a camera that is carried by hand and not simulated "
                        "needs it; allowed is " +
                        (std::string(key) == "lens"
                             ? "the folder of turnlight calibrate intrinsics, or a .cameramodel"
                             : "an object as in session.json, {encoding, black, white}"));
  if (!config.calibration && !config.plan.by_hand)
    return InputError(config.rig.Where("calibration") +
                      ": this key is missing, a rig that is not simulated needs it; allowed is " +
                      kCalibrationIs);
  if (!config.target)
    return InputError(config.rig.Where("target") +
                      ": this key is missing, a rig that is not simulated needs it; allowed is "
                      "{shape: sphere, radius}, {shape: plane, size} or {shape: mesh, path}");
  return {};
}

// The simulation turns in a way that no calibration can say.
Status RequireTurntable(const RunConfig& config) {
  const bool orbit = config.simulation->camera.scene.motion.kind == rig::sim::MotionKind::kOrbit;
  if (!config.calibration || !orbit) return {};
  return InputError(config.rig.Where("calibration") +
                    ": it is of a rig whose target turns, simulation/motion/kind is orbit; allowed "
                    "is kind: table, or no calibration");
}

// A camera that is carried by hand: where it is, its pictures say.
rig::RigKnowledge WithoutTable(const RunConfig& config, rig::RigKnowledge known) {
  if (config.lens) known.lens = *config.lens;
  if (config.radiometry) known.radiometry = *config.radiometry;
  return known;
}

// What moves by itself does not wait for a clock that jumps.
Status RequireWallClock(const RunConfig& config, const rig::TableDevice& table,
                        const rig::CameraDevice& camera) {
  if (config.graph.executor == nodes::graph::ExecutorKind::kWall) return {};
  if (!table.real_time && !camera.real_time) return {};
  return InputError(StrictObject(*config.graph.document).Object("graph").Where("executor") +
                    ": virtual, allowed with the driver " +
                    StrictObject(table.real_time ? *config.table : config.camera).String("driver") +
                    ", whose device lives in real time, is wall");
}

Result<rig::RigSetup> MakeRealRig(const RunConfig& config, const Chosen& chosen) {
  if (const Status status = RequireKnown(config); !status) return Forward(status);
  auto table = chosen.table ? Make(*chosen.table, *chosen.table_keys, nullptr)
                            : Result<rig::TableDevice>(rig::TableDevice());
  if (!table) return Forward(table);
  auto camera = Make(*chosen.camera, chosen.camera_keys, nullptr);
  if (!camera) return Forward(camera);
  if (const Status status = RequireWallClock(config, *table, *camera); !status)
    return Forward(status);
  return rig::RigSetup{.table = std::move(*table),
                       .camera = std::move(*camera),
                       .length_unit = config.length_unit,
                       .known = config.calibration
                                    ? rig::KnowledgeOf(*config.calibration)
                                    : rig::RigKnowledge{*config.lens, {}, *config.radiometry, {}},
                       .target = *config.target,
                       .calibration = config.calibration,
                       .truth = {},
                       .identity = {}};
}

Result<rig::RigSetup> MakeSimulatedRig(const RunConfig& config, const Chosen& chosen) {
  if (const Status status = RequireTurntable(config); !status) return Forward(status);
  auto world = rig::sim::BuildWorld(*config.simulation);
  if (!world) return Forward(world);
  auto table = chosen.table ? Make(*chosen.table, *chosen.table_keys, &*world)
                            : Result<rig::TableDevice>(rig::TableDevice());
  if (!table) return Forward(table);
  auto camera = Make(*chosen.camera, chosen.camera_keys, &*world);
  if (!camera) return Forward(camera);
  return rig::RigSetup{
      .table = std::move(*table),
      .camera = std::move(*camera),
      .length_unit = config.length_unit,
      .known = config.calibration ? rig::KnowledgeOf(*config.calibration)
                                  : WithoutTable(config, rig::sim::KnowledgeOf(*world)),
      .target = config.target ? *config.target : rig::sim::TargetOf(*world),
      .calibration = config.calibration,
      .truth =
          estimator::results::TruthToJson(estimator::model::WithoutFactors(world->studio->scene),
                                          "the simulated rig of " + config.name),
      .identity = {}};
}

}  // namespace

Result<rig::RigTarget> ReadRigTarget(StrictObject target, const fs::path& folder) {
  return ReadTarget(std::move(target), folder);
}

Result<CalibrationOfRig> ReadRigCalibrationKey(StrictObject& rig, const fs::path& folder) {
  const nlohmann::json& value = rig.Raw("calibration");
  if (value.is_null()) return CalibrationOfRig();
  CalibrationOfRig read;
  auto calibration = Result<rig::RigCalibration>(InputError(""));
  if (value.is_string()) {
    const fs::path path = folder / value.get<std::string>();
    auto text = ReadFile(path);
    if (!text)
      return InputError(rig.Where("calibration") + ": " + text.error().text +
                        "; a rig has to be calibrated before it captures: turnlight calibrate rig "
                        "does it (docs/calibrating.md). Of simulated devices turnlight simulate "
                        "SIM.yaml --calibration FILE writes it");
    read.text = std::move(*text);
    calibration = rig::ReadRigCalibration(path);
  } else if (value.is_object()) {
    calibration = rig::ReadRigCalibration(rig.Object("calibration"), folder);
  } else {
    return InputError(rig.Where("calibration") + ": " + value.dump() + ", allowed is " +
                      kCalibrationIs);
  }
  if (!calibration) return Forward(calibration);
  read.calibration = std::move(*calibration);
  return read;
}

namespace {

// The keys of a rig without a table that stand for a calibration; the bytes of the lens.
Result<std::string> ReadByHand(StrictObject& rig, const fs::path& folder, RunConfig& config) {
  const auto lens = rig.OptionalString("lens");
  auto radiometry = rig.OptionalObject("radiometry");
  if (radiometry) {
    config.radiometry.emplace();
    if (const Status status = rig::ReadRadiometry(*radiometry, *config.radiometry); !status)
      return Forward(status);
    if (const Status status = radiometry->Finish(); !status) return Forward(status);
  }
  if (!lens) return std::string();
  auto read = ReadCalibratedLens(folder / *lens);
  if (!read) return InputError(rig.Where("lens") + ": " + read.error().text);
  config.lens = std::move(read->camera);
  return config.lens->ToString();
}

}  // namespace

Result<RigFiles> ReadRigSection(const fs::path& folder, RunConfig& config) {
  StrictObject& rig = config.rig;
  if (!config.plan.by_hand) config.table = rig.Object("table");
  config.camera = rig.Object("camera");
  const auto target = rig.OptionalObject("target");
  const auto unit = rig.OptionalString("length_unit");
  if (unit && !rig::IsWord(*unit))
    rig.Refuse("length_unit", "a word without spaces, such as \"mm\"");
  auto calibration = config.plan.by_hand ? Result<CalibrationOfRig>(CalibrationOfRig())
                                         : ReadRigCalibrationKey(rig, folder);
  if (config.plan.by_hand && calibration) {
    auto lens = ReadByHand(rig, folder, config);
    if (!lens) return Forward(lens);
    calibration->text = std::move(*lens);
  }
  if (const Status status = rig.Finish(); !status) return Forward(status);
  if (!calibration) return Forward(calibration);
  config.calibration = std::move(calibration->calibration);
  if (config.calibration && unit && *unit != config.calibration->length_unit)
    return InputError(rig.Where("length_unit") + ": " + *unit + ", allowed is the calibration's, " +
                      config.calibration->length_unit);
  config.length_unit =
      config.calibration ? config.calibration->length_unit : unit.value_or(config.length_unit);
  RigFiles files{std::move(calibration->text), ""};
  if (!target) return files;
  auto read = ReadTarget(*target, folder);
  if (!read) return Forward(read);
  config.target = std::move(*read);
  if (const auto* mesh = std::get_if<rig::MeshCopy>(&config.target->copy)) files.mesh = mesh->bytes;
  return files;
}

Result<rig::RigSetup> MakeRig(const RunConfig& config, const Drivers& drivers) {
  const auto chosen = Choose(config, drivers);
  if (!chosen) return Forward(chosen);
  if (const Status status = CheckWorld(config, *chosen); !status) return Forward(status);
  auto rig = config.simulation ? MakeSimulatedRig(config, *chosen) : MakeRealRig(config, *chosen);
  if (!rig || !rig->calibration) return rig;
  if (const Status status = rig::CheckTargetPlaced(*rig->calibration); !status)
    return Forward(status);
  if (const Status status = rig::CheckPictures(*rig->calibration, rig->camera); !status)
    return Forward(status);
  return rig;
}

rig::CaptureSetup MakeCaptureSetup(const RunConfig& config, const rig::RigSetup& rig,
                                   const std::string& camera, const std::string& table) {
  return {.plan = config.plan,
          .config_text = config.text + config.calibration_text,
          .name = config.name,
          .length_unit = rig.length_unit,
          .camera = rig.known.lens,
          .calibration_text =
              rig.calibration ? rig::PrintRigCalibration(*rig.calibration, rig::kCaptureCameraFile)
                              : "",
          .radiometry = rig.known.radiometry,
          .bayer = rig.camera.bayer,
          .target = rig.target.copy,
          .format = rig.camera.format,
          .camera_identity = camera,
          .table_identity = table};
}

Result<nodes::graph::Graph> BuildGraph(const RunConfig& config, const rig::RigSetup& rig,
                                       std::shared_ptr<const nodes::CaptureWork> work) {
  nodes::KeyframesJob job;
  job.plan = config.plan;
  auto graph = nodes::graph::Graph::Build(
      config.graph, nodes::CaptureNodes({rig, std::move(job), std::move(work)}));
  if (!graph) return graph;
  if (const Status status = graph->Configure(); !status) return Forward(status);
  return graph;
}

}  // namespace turnlight::app
