// The devices of `turnlight simulate`: a stage's controller on a pseudo-terminal and a GigE Vision
// camera, in one simulated world, in this process.
//
// The config is a YAML file: all keys of rig/sim/simulation.h at its top level, and
//   keyframes: {start_deg: 0, step_deg: 10, count: 36}   optional: what `at: {keyframe: N}` of the
//                                                        fault script means
//   devices:                     at least one of
//     table: {...}               rig/sim/stage/stage_config.h
//     camera: {...}              rig/sim/gige/camera_config.h
// Without a table the target stands at table/power_on_deg.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "base/result.h"
#include "rig/rig_calibration.h"
#include "rig/sim/gige/gige_camera.h"
#include "rig/sim/mock_drivers.h"
#include "rig/sim/stage/stage_simulator.h"

namespace turnlight::app {

struct SimulatorConfig {
  rig::sim::SimulationConfig simulation;
  std::optional<rig::sim::stage::StageConfig> table;
  std::optional<rig::sim::gige::CameraConfig> camera;
};

// Fails (kInput) with file, line, key and what is allowed.
Result<SimulatorConfig> ReadSimulatorConfig(const std::filesystem::path& path);
// Whether the file is one: whether it has the key devices. Fails (kInput) if it cannot be read.
Result<bool> IsSimulatorConfig(const std::filesystem::path& path);

// What is true of the rig, in the DN of the camera's format and with its devices as the program's
// drivers see them; for that the table's controller runs for a moment, on a port of its own. Fails:
// a device is missing, the camera goes round (kInput), the driver does not know the table
// (kDevice).
Result<rig::RigCalibration> CalibrationOf(const SimulatorConfig& config);

class Simulator {
 public:
  // Fails (kInput, kSystem) if the link or the address is taken, naming it.
  static Result<std::unique_ptr<Simulator>> Start(SimulatorConfig config);

  // "table grbl at /tmp/stage, camera SIM-CAMERA-1 at 127.0.0.1".
  std::string Where() const;
  // "72 moves, 36 triggers, 36 frames, 0 faults struck", of the devices that there are.
  std::string Counts() const;
  const rig::sim::FaultScript& faults() const { return *world_.faults; }

 private:
  Simulator(SimulatorConfig config, rig::sim::SimulatedWorld world);

  const SimulatorConfig config_;
  rig::sim::SimulatedWorld world_;
  std::unique_ptr<rig::sim::stage::StageSimulator> stage_;
  std::unique_ptr<rig::sim::gige::GigeCamera> camera_;
};

}  // namespace turnlight::app
