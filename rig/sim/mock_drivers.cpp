#include "rig/sim/mock_drivers.h"

#include <utility>

#include "rig/sim/blob.h"
#include "rig/sim/mock_camera.h"

namespace turnlight::rig::sim {
namespace {

PictureFormat FormatOf(const SyntheticConfig& scene) {
  PictureFormat format;
  format.size = {scene.camera.width, scene.camera.height};
  format.channels = 3;
  format.depth = scene.sensor.depth == SensorDepth::k8    ? CV_8U
                 : scene.sensor.depth == SensorDepth::k16 ? CV_16U
                                                          : CV_32F;
  return format;
}

CaptureTarget CopyOf(const calib::TargetShape& shape) {
  if (const auto* sphere = std::get_if<calib::SphereShape>(&shape)) return *sphere;
  if (const auto* plane = std::get_if<calib::PlaneShape>(&shape)) return *plane;
  return MeshCopy{MeshFormat::kPly, MeshToPly(std::get<calib::MeshShape>(shape))};
}

}  // namespace

SensorNoise NoiseOf(const Sensor& sensor, const calib::Radiometry& radiometry) {
  const double span = radiometry.white - radiometry.black;
  SensorNoise noise;
  noise.read_noise_dn = sensor.noise_relative * span;
  noise.dn_per_electron = sensor.noise_shot * sensor.noise_shot * span;
  return noise;
}

Result<SimulatedWorld> BuildWorld(SimulationConfig config) {
  auto studio = BuildStudio(config.camera);
  if (!studio) return Forward(studio);
  SimulatedWorld world{std::move(config), nullptr,
                       std::make_shared<const Studio>(std::move(*studio)), nullptr};
  world.faults = std::make_shared<FaultScript>(world.config.faults);
  // A camera that is carried has none, but faults are told by the angle of one that stands.
  if (world.config.camera.walk)
    world.table = std::make_shared<MockTurntable>(world.config.table, world.faults);
  return world;
}

Result<TableDevice> MakeMockTable(StrictObject object, SimulatedWorld& world) {
  MockTurntableConfig config = world.config.table;
  if (Status status = ReadTableDevice(std::move(object), config); !status) return Forward(status);
  world.table = std::make_shared<MockTurntable>(config, world.faults);
  return TableDevice{world.table, {config.max_speed_deg_s, config.acceleration_deg_s2}};
}

Result<CameraDevice> MakeMockCamera(StrictObject object, const SimulatedWorld& world) {
  if (!world.table)
    return InputError(object.Where("driver") +
                      ": mock, allowed is that with the table's driver mock: it photographs at the "
                      "true angle of that table");
  MockCameraConfig config = world.config.camera;
  if (Status status = ReadCameraDevice(std::move(object), config); !status) return Forward(status);
  CameraDevice device;
  device.camera = std::make_shared<MockCamera>(config, world.studio, world.table, world.faults);
  device.format = FormatOf(config.scene);
  device.readout_s = config.readout_ms * 1e-3;
  return device;
}

RigKnowledge KnowledgeOf(const SimulatedWorld& world) {
  const SyntheticConfig& scene = world.config.camera.scene;
  const Studio& studio = *world.studio;
  return {studio.camera, studio.rig, studio.radiometry, NoiseOf(scene.sensor, studio.radiometry)};
}

RigTarget TargetOf(const SimulatedWorld& world) {
  return {world.studio->target, CopyOf(world.studio->target)};
}

}  // namespace turnlight::rig::sim
