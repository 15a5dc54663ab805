#include "rig/sim/simulation.h"

#include <utility>

namespace turnlight::rig::sim {

Result<SimulationConfig> ReadSimulation(StrictObject object, const KeyframeAngles& angles,
                                        FaultWorld world) {
  SimulationConfig config;
  const auto table = object.OptionalObject("table");
  const auto shutter = object.OptionalObject("shutter");
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
  if (!faults) return config;
  auto entries = ReadFaultScript(*faults, angles, world);
  if (!entries) return Forward(entries);
  config.faults = std::move(*entries);
  return config;
}

}  // namespace turnlight::rig::sim
