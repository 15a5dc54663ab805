// What the mock turntable and the mock camera are like. Each has two kinds of keys: those of the
// device, which stand in a config under rig/table and rig/camera as those of a real driver do, and
// those of the simulated world, which stand under simulation/table and simulation/shutter
// (rig/sim/simulation.h).
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "base/result.h"
#include "base/strict_object.h"
#include "rig/sim/config_fields.h"
#include "rig/sim/prop.h"
#include "rig/sim/synthetic_config.h"
#include "rig/sim/true_geometry.h"
#include "rig/sim/walk.h"

namespace turnlight::rig::sim {

enum class TableFeedback {
  kOpenLoop,  // the controller reports the steps it sent, whether the motor took them or not
  kEncoder,   // it reports the motor's shaft: sees lost steps and stalls, not the backlash
};

struct MockTurntableConfig {
  // Of the device.
  std::string serial = "MOCK-TABLE-1";
  double max_speed_deg_s = 30.0;       // 0.001..1e4
  double acceleration_deg_s2 = 120.0;  // 0.001..1e6
  double home_speed_deg_s = 60.0;      // 0.001..1e4
  double steps_per_deg = 100.0;        // above 0, at most 1e6
  TableFeedback feedback = TableFeedback::kEncoder;

  // Of the world.
  // True degrees per commanded degree, -10..10 but not 0. Other than 1: a table set up with wrong
  // steps per revolution; -1: with a wrong direction.
  double scale = 1.0;
  double backlash_deg = 0.05;          // 0..10
  double settle_amplitude_deg = 0.02;  // 0..10; of the swing after arrival
  double settle_frequency_hz = 12.0;   // above 0, at most 1e4
  double settle_ms = 250.0;            // 0..60000; the swing is over, exactly
  double home_switch_deg = 0.0;        // -360..360; where the switch is, and the count after homing
  double power_on_deg = 217.3;         // -360..360; where it stands when switched on
};

struct MockCameraConfig {
  // Of the device.
  std::string serial = "MOCK-CAMERA-1";
  double readout_ms = 15.0;      // 0..10000
  int first_frame_id = 1;        // 1..65535; ids wrap 65535 -> 1
  bool reports_trigger = false;  // whether frames say which trigger they answer

  // Of the world.
  SyntheticConfig scene;                    // without masks and clip_share
  TrueGeometry geometry;                    // of a table; of an orbit as by default
  std::optional<Prop> prop;                 // stands there instead of the scene's target
  std::optional<Walk> walk;                 // the camera is carried; without a prop
  double reference_exposure_us = 8000.0;    // 10..1e7
  double trigger_latency_ms = 0.2;          // 0..1000
  double blur_threshold_deg = 1e-4;         // 0..10
  int blur_samples = 8;                     // 2..64
  std::optional<std::uint64_t> noise_seed;  // of the pictures' noise; the scene's seed if not given
};

std::optional<ConfigProblem> Validate(const MockTurntableConfig& config);
std::optional<ConfigProblem> Validate(const MockCameraConfig& config);

// Whether a camera can photograph the scene: what only a generated session has is refused.
std::optional<ConfigProblem> CheckPhotographed(const SyntheticConfig& scene);

// Each reads its keys, all optional, into a config and validates; unknown keys are refused.
// Messages name file, line, key and what is allowed. Of the device: serial, max_speed_deg_s,
// acceleration_deg_s2, home_speed_deg_s, steps_per_deg, feedback (open_loop, encoder); of the
// world: scale, backlash_deg, settle_amplitude_deg, settle_frequency_hz, settle_ms,
// home_switch_deg, power_on_deg.
Status ReadTableDevice(StrictObject object, MockTurntableConfig& config);
// The keys of the device alone, where others stand beside them; Validate is the caller's to call.
void ReadTableKeys(StrictObject& object, MockTurntableConfig& config);
Status ReadTableWorld(StrictObject object, MockTurntableConfig& config);
// Of the device: serial, readout_ms, first_frame_id, reports_trigger; of the world, where the scene
// is not read: reference_exposure_us, trigger_latency_ms, blur_threshold_deg, blur_samples,
// noise_seed.
Status ReadCameraDevice(StrictObject object, MockCameraConfig& config);
Status ReadShutter(StrictObject object, MockCameraConfig& config);

}  // namespace turnlight::rig::sim
