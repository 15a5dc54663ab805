// The section rig of a run's config, and the rig that it makes: the one place where drivers, a
// calibration and the simulation come together.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "app/drivers.h"
#include "app/run_config.h"
#include "base/result.h"
#include "nodes/capture_work.h"
#include "nodes/graph/graph.h"
#include "rig/rig_setup.h"

namespace turnlight::app {

// As a section rig and what is beside it look, for messages.
inline constexpr char kRigExample[] =
    "  rig:\n"
    "    table: {driver: mock, max_speed_deg_s: 30, acceleration_deg_s2: 120}\n"
    "    camera: {driver: mock}\n"
    "  simulation:\n"
    "    target: {shape: sphere, radius: 50}\n"
    "    motion: {kind: table, distance: 420, elevation_deg: 30}\n"
    "    faults: {list: []}\n";

// What the section's key calibration says: a path, or the same keys in place. Fails (kInput).
struct CalibrationOfRig {
  std::optional<rig::RigCalibration> calibration;  // if the key is there
  std::string text;                                // of the file, if it is one
};
Result<CalibrationOfRig> ReadRigCalibrationKey(StrictObject& rig,
                                               const std::filesystem::path& folder);

// The section's target; its mesh is relative to folder. Fails (kInput).
Result<rig::RigTarget> ReadRigTarget(StrictObject target, const std::filesystem::path& folder);

// The bytes of the files that the section names; empty if it names none.
struct RigFiles {
  std::string calibration, mesh;  // the calibration's, or the lens's
};
// Reads all of config.rig but the drivers' keys into config.
// config.plan says whether there is a table.
Result<RigFiles> ReadRigSection(const std::filesystem::path& folder, RunConfig& config);

// Makes the devices, closed, and puts together what is known of them. Fails (kInput): a driver that
// is not in the table; keys that it refuses; a simulation beside real devices, or simulated devices
// without one; real devices without calibration or target.
Result<rig::RigSetup> MakeRig(const RunConfig& config, const Drivers& drivers = BuiltInDrivers());

// What the recorder needs to know. The identities are rig::Describe's texts.
rig::CaptureSetup MakeCaptureSetup(const RunConfig& config, const rig::RigSetup& rig,
                                   const std::string& camera, const std::string& table);

// Built and given its params; nothing runs. work is filled in before it does. Fails (kInput) with
// file, line, key and what is allowed.
Result<nodes::graph::Graph> BuildGraph(
    const RunConfig& config, const rig::RigSetup& rig,
    std::shared_ptr<const nodes::CaptureWork> work = std::make_shared<const nodes::CaptureWork>());

}  // namespace turnlight::app
