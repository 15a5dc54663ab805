#include "app/simulator.h"

#include <unistd.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>
#include <variant>

#include "app/drivers.h"
#include "base/document.h"
#include "base/file.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;
namespace stage = rig::sim::stage;
namespace gige = rig::sim::gige;

constexpr std::uint64_t kMaxConfigBytes = std::uint64_t{16} << 20;
constexpr double kMaxKeyframeDeg = 36000.0;

Result<Document> ReadDocument(const fs::path& path) {
  const auto text = ReadTypedFile(path, kMaxConfigBytes);
  if (!text) return Forward(text);
  return ParseYaml(*text, path.string());
}

Result<rig::sim::KeyframeAngles> ReadKeyframes(std::optional<StrictObject> object) {
  rig::sim::KeyframeAngles angles;
  if (!object) return angles;
  const Range range{.min = -kMaxKeyframeDeg, .max = kMaxKeyframeDeg};
  angles.start_deg = object->OptionalNumber("start_deg", range).value_or(angles.start_deg);
  angles.step_deg = object->OptionalNumber("step_deg", range).value_or(angles.step_deg);
  angles.count =
      static_cast<int>(object->OptionalInteger("count", 1, 100000).value_or(angles.count));
  if (const Status status = object->Finish(); !status) return Forward(status);
  return angles;
}

Status ReadDevices(StrictObject devices, SimulatorConfig& config) {
  const auto table = devices.OptionalObject("table");
  const auto camera = devices.OptionalObject("camera");
  if (const Status status = devices.Finish(); !status) return status;
  if (!table && !camera)
    return InputError(devices.Where("") + ": it is empty, allowed is table, camera or both");
  if (table) {
    auto read = stage::ReadStageConfig(*table, config.simulation.table);
    if (!read) return Forward(read);
    config.table = std::move(*read);
  }
  if (camera) {
    auto read = gige::ReadCamera(*camera, config.simulation);
    if (!read) return Forward(read);
    config.camera = std::move(*read);
  }
  return {};
}

// The driver's name, which is the firmware's, and the keys that it needs to find the controller.
struct DriverKeys {
  std::string driver;
  nlohmann::json keys;
};

DriverKeys DriverKeysOf(const stage::StageConfig& config) {
  if (const auto* grbl = std::get_if<stage::GrblConfig>(&config.firmware))
    return {"grbl", {{"axis", std::string(1, grbl->axis)}}};
  if (const auto* zaber = std::get_if<stage::ZaberConfig>(&config.firmware))
    return {"zaber", {{"device", zaber->device}}};
  return {"smc100", {{"address", std::get<stage::Smc100Config>(config.firmware).address}}};
}

Result<rig::DeviceIdentity> IdentifyTable(stage::StageConfig config) {
  const DriverKeys own = DriverKeysOf(config);
  config.link = fs::temp_directory_path() / ("turnlight_identify_" + std::to_string(::getpid()));
  const auto& drivers = BuiltInDrivers().tables;
  const auto driver = std::find_if(drivers.begin(), drivers.end(),
                                   [&](const auto& known) { return known.name == own.driver; });
  if (driver == drivers.end() || driver->simulated())
    return DeviceError("no driver " + own.driver +
                       " in this program, so the table's identity is unknown");
  const auto controller =
      stage::StageSimulator::Start(config, nullptr, gige::GigeCamera::Clock::now());
  if (!controller) return Forward(controller);
  nlohmann::json keys = own.keys;
  keys["port"] = config.link.string();
  const auto document = ParseJson(keys.dump(), "the driver's keys");
  if (!document) return Forward(document);
  auto table = std::get<RealDriver<rig::TableDevice>>(driver->make)(StrictObject(*document));
  if (!table) return Forward(table);
  return table->turntable->Open(rig::DeviceTime(0));
}

}  // namespace

Result<SimulatorConfig> ReadSimulatorConfig(const fs::path& path) {
  const auto document = ReadDocument(path);
  if (!document) return Forward(document);
  StrictObject root(*document);
  const auto angles = ReadKeyframes(root.OptionalObject("keyframes"));
  const StrictObject devices = root.Object("devices");
  if (!root.ok()) return Forward(root.Finish());
  if (!angles) return Forward(angles);
  // Knows by now the keys that are not the simulation's.
  auto simulation = rig::sim::ReadSimulation(root, *angles, rig::sim::FaultWorld::kRealProtocols);
  if (!simulation) return Forward(simulation);
  SimulatorConfig config{std::move(*simulation), {}, {}};
  if (const Status status = ReadDevices(devices, config); !status) return Forward(status);
  return config;
}

Result<bool> IsSimulatorConfig(const fs::path& path) {
  const auto document = ReadDocument(path);
  if (!document) return Forward(document);
  return document->root.is_object() && document->root.contains("devices");
}

Result<rig::RigCalibration> CalibrationOf(const SimulatorConfig& config) {
  if (!config.table || !config.camera)
    return InputError(std::string("devices: no ") + (config.table ? "camera" : "table") +
                      ", allowed for a calibration are both");
  if (config.simulation.camera.scene.motion.kind != rig::sim::MotionKind::kTable)
    return InputError("motion/kind: orbit, allowed for a calibration is table");
  const auto world = rig::sim::BuildWorld(config.simulation);
  if (!world) return Forward(world);
  const auto table = IdentifyTable(*config.table);
  if (!table) return Forward(table);
  rig::RigKnowledge known = gige::KnowledgeOf(*world, *config.camera);
  rig::RigCalibration calibration(known.lens);
  calibration.geometry = std::get<calib::TurntableGeometry>(known.geometry);
  calibration.radiometry = known.radiometry;
  calibration.noise = known.noise;
  calibration.devices.camera = gige::IdentityOf(*config.camera);
  calibration.devices.table = *table;
  calibration.devices.resolution = {known.lens.width(), known.lens.height()};
  calibration.devices.lens = "simulated";
  return calibration;
}

Simulator::Simulator(SimulatorConfig config, rig::sim::SimulatedWorld world)
    : config_(std::move(config)), world_(std::move(world)) {}

Result<std::unique_ptr<Simulator>> Simulator::Start(SimulatorConfig config) {
  auto world = rig::sim::BuildWorld(config.simulation);
  if (!world) return Forward(world);
  std::unique_ptr<Simulator> simulator(new Simulator(std::move(config), std::move(*world)));
  const SimulatorConfig& set = simulator->config_;
  rig::sim::SimulatedWorld& in = simulator->world_;
  const auto epoch = gige::GigeCamera::Clock::now();
  if (set.table) {
    auto stage = stage::StageSimulator::Start(*set.table, in.faults, epoch);
    if (!stage) return Forward(stage);
    simulator->stage_ = std::move(*stage);
    in.table = simulator->stage_->table();
  } else {
    in.table = std::make_shared<rig::sim::MockTurntable>(set.simulation.table);
  }
  if (!set.camera) return simulator;
  auto camera = gige::GigeCamera::Start(*set.camera, in, epoch);
  if (!camera) return Forward(camera);
  simulator->camera_ = std::move(*camera);
  return simulator;
}

std::string Simulator::Where() const {
  std::string text;
  if (config_.table)
    text = "table " + DriverKeysOf(*config_.table).driver + " at " + config_.table->link.string();
  if (config_.camera)
    text += (text.empty() ? "camera " : ", camera ") + config_.camera->camera.serial + " at " +
            config_.camera->address;
  return text;
}

std::string Simulator::Counts() const {
  std::string text;
  if (stage_) text = std::to_string(world_.table->moves()) + " moves, ";
  if (camera_)
    text += std::to_string(camera_->counts().triggers) + " triggers, " +
            std::to_string(camera_->counts().frames) + " frames, ";
  return text + std::to_string(faults().Fired().size()) + " faults struck";
}

}  // namespace turnlight::app
