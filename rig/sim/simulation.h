// The simulated world that mock devices are in: what is true of it, and what goes wrong. In a
// config it stands under `simulation`, beside `rig`; by itself it is the whole of a simulator's
// config. Lengths are in the rig's length_unit.
//
// Keys (all optional): those of rig/sim/synthetic_config.h - seed, target, motion, camera (the true
// lens), lights or random_lights, reflectance or random_reflectance, sensor, samples_per_side; of
// its motion frames and step_deg mean nothing here, masks and sensor/clip_share must be left out -
// and
//   table    how the table really moves (rig/sim/mock_config.h)
//   shutter  reference_exposure_us, trigger_latency_ms, blur_threshold_deg, blur_samples,
//   noise_seed
//            (there)
//   geometry where axis and target really are (rig/sim/true_geometry.h); motion/kind must be table
//   prop     what stands there instead of the target (rig/sim/prop.h)
//   walk     the camera is carried round target and board (rig/sim/walk.h); motion/kind must be
//            orbit, without prop
//   faults   what goes wrong, and when (rig/sim/fault_script.h)
#pragma once

#include <vector>

#include "base/result.h"
#include "base/strict_object.h"
#include "rig/sim/fault_script.h"
#include "rig/sim/mock_config.h"

namespace turnlight::rig::sim {

struct SimulationConfig {
  MockTurntableConfig table;
  MockCameraConfig camera;  // with the scene
  std::vector<FaultEntry> faults;
};

// Reads and validates; refuses unknown keys. Messages name file, line, key and what is allowed.
Result<SimulationConfig> ReadSimulation(StrictObject object, const KeyframeAngles& angles,
                                        FaultWorld world = FaultWorld::kMocks);

}  // namespace turnlight::rig::sim
