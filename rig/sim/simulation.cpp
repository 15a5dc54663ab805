#include "rig/sim/simulation.h"

#include <utility>

namespace turnlight::rig::sim {
namespace {

Status ReadPlaces(const std::optional<StrictObject>& geometry,
                  const std::optional<StrictObject>& prop, MockCameraConfig& camera) {
  if (geometry) {
    if (camera.scene.motion.kind != MotionKind::kTable)
      return InputError(geometry->Where("") + ": motion/kind is orbit, allowed is this section " +
                        "where it is table");
    if (Status status = ReadTrueGeometry(*geometry, camera.geometry); !status) return status;
  }
  if (!prop) return {};
  auto read = ReadProp(*prop);
  if (!read) return Forward(read);
  camera.prop = std::move(*read);
  return {};
}

}  // namespace

Result<SimulationConfig> ReadSimulation(StrictObject object, const KeyframeAngles& angles,
                                        FaultWorld world) {
  SimulationConfig config;
  const auto table = object.OptionalObject("table");
  const auto shutter = object.OptionalObject("shutter");
  const auto geometry = object.OptionalObject("geometry");
  const auto prop = object.OptionalObject("prop");
  const auto walk = object.OptionalObject("walk");
  const auto faults = object.OptionalObject("faults");
  // Knows by now the keys that are not the scene's.
  auto scene = ReadSyntheticConfig(object);
  if (!scene) return Forward(scene);
  if (const auto problem = CheckPhotographed(*scene))
    return InputError(object.Where(problem->key) + ": " + problem->text);
  config.camera.scene = std::move(*scene);
  if (table)
    if (Status status = ReadTableWorld(*table, config.table); !status) return Forward(status);
  if (shutter)
    if (Status status = ReadShutter(*shutter, config.camera); !status) return Forward(status);
  if (Status status = ReadPlaces(geometry, prop, config.camera); !status) return Forward(status);
  if (walk) {
    if (config.camera.scene.motion.kind != MotionKind::kOrbit || prop)
      return InputError(walk->Where("") +
                        (prop ? ": it stands beside prop" : ": motion/kind is table") +
                        ", allowed is this section without prop, where motion/kind is orbit");
    auto read = ReadWalk(*walk);
    if (!read) return Forward(read);
    config.camera.walk = std::move(*read);
  }
  if (!faults) return config;
  auto entries = ReadFaultScript(*faults, angles, world);
  if (!entries) return Forward(entries);
  config.faults = std::move(*entries);
  return config;
}

}  // namespace turnlight::rig::sim
