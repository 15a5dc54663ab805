// The simulated world with the devices in it, and what a session says of it.
#pragma once

#include <memory>
#include <string>

#include "base/result.h"
#include "base/strict_object.h"
#include "rig/driver.h"
#include "rig/rig_setup.h"
#include "rig/sim/fault_script.h"
#include "rig/sim/mock_turntable.h"
#include "rig/sim/simulation.h"
#include "rig/sim/studio.h"

namespace turnlight::rig::sim {

// Shared by the devices in it: the camera photographs at the table's true angle.
struct SimulatedWorld {
  SimulationConfig config;
  std::shared_ptr<FaultScript> faults;
  std::shared_ptr<const Studio> studio;  // its radiometry with both references
  std::shared_ptr<MockTurntable> table;  // once its driver has made it
};

// Fails (kInput): lights that cannot be placed as asked.
Result<SimulatedWorld> BuildWorld(SimulationConfig config);

// The drivers `mock`; their keys are those of the device in rig/sim/mock_config.h. The table comes
// first.
Result<TableDevice> MakeMockTable(StrictObject object, SimulatedWorld& world);
Result<CameraDevice> MakeMockCamera(StrictObject object, const SimulatedWorld& world);

// What is known of the world exactly: lens, geometry, radiometry, noise; its target.
RigKnowledge KnowledgeOf(const SimulatedWorld& world);
// The simulated sensor's noise in the merge's terms, for DN of that radiometry.
SensorNoise NoiseOf(const Sensor& sensor, const calib::Radiometry& radiometry);
RigTarget TargetOf(const SimulatedWorld& world);

}  // namespace turnlight::rig::sim
