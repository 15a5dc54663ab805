#include "rig/sim/mock_config.h"

namespace turnlight::rig::sim {
namespace {

void CheckSerial(ConfigChecker& check, const std::string& serial) {
  check.Require(!serial.empty() && serial.size() <= 100, "serial",
                "it has " + std::to_string(serial.size()) + " characters, allowed are 1 to 100");
}

// What a reader says when its keys are read.
template <typename Config>
Status Settle(StrictObject& object, const Config& config) {
  if (Status status = object.Finish(); !status) return status;
  if (const auto problem = Validate(config))
    return InputError(object.Where(problem->key) + ": " + problem->text);
  return {};
}

}  // namespace

std::optional<ConfigProblem> Validate(const MockTurntableConfig& config) {
  ConfigChecker check;
  CheckSerial(check, config.serial);
  check.From("max_speed_deg_s", config.max_speed_deg_s, 1e-3, 1e4);
  check.From("acceleration_deg_s2", config.acceleration_deg_s2, 1e-3, 1e6);
  check.From("home_speed_deg_s", config.home_speed_deg_s, 1e-3, 1e4);
  check.Above("steps_per_deg", config.steps_per_deg, 0.0, 1e6);
  check.From("scale", config.scale, -10.0, 10.0);
  check.Require(config.scale != 0.0, "scale", "0, allowed is any other number from -10 to 10");
  check.From("backlash_deg", config.backlash_deg, 0.0, 10.0);
  check.From("settle_amplitude_deg", config.settle_amplitude_deg, 0.0, 10.0);
  check.Above("settle_frequency_hz", config.settle_frequency_hz, 0.0, 1e4);
  check.From("settle_ms", config.settle_ms, 0.0, 60000.0);
  check.From("home_switch_deg", config.home_switch_deg, -360.0, 360.0);
  check.From("power_on_deg", config.power_on_deg, -360.0, 360.0);
  return check.problem();
}

std::optional<ConfigProblem> CheckPhotographed(const SyntheticConfig& scene) {
  ConfigChecker check;
  check.Require(!scene.masks, "masks", "true, allowed is false: a camera gives none");
  check.Require(!scene.sensor.clip_share, "sensor/clip_share",
                "a number, allowed is null: the capture sets the exposure");
  return check.problem();
}

std::optional<ConfigProblem> Validate(const MockCameraConfig& config) {
  ConfigChecker check;
  CheckSerial(check, config.serial);
  for (const auto& problem : {Validate(config.scene), CheckPhotographed(config.scene)})
    if (problem) check.Require(false, "scene/" + problem->key, problem->text);
  check.From("readout_ms", config.readout_ms, 0.0, 10000.0);
  check.From("first_frame_id", config.first_frame_id, 1, 65535);
  check.From("reference_exposure_us", config.reference_exposure_us, 10.0, 1e7);
  check.From("trigger_latency_ms", config.trigger_latency_ms, 0.0, 1000.0);
  check.From("blur_threshold_deg", config.blur_threshold_deg, 0.0, 10.0);
  check.From("blur_samples", config.blur_samples, 2, 64);
  return check.problem();
}

void ReadTableKeys(StrictObject& object, MockTurntableConfig& config) {
  ReadField(object, "serial", config.serial);
  ReadField(object, "max_speed_deg_s", config.max_speed_deg_s);
  ReadField(object, "acceleration_deg_s2", config.acceleration_deg_s2);
  ReadField(object, "home_speed_deg_s", config.home_speed_deg_s);
  ReadField(object, "steps_per_deg", config.steps_per_deg);
  const auto feedback = object.OptionalChoice("feedback", {"open_loop", "encoder"});
  if (feedback)
    config.feedback = *feedback == "encoder" ? TableFeedback::kEncoder : TableFeedback::kOpenLoop;
}

Status ReadTableDevice(StrictObject object, MockTurntableConfig& config) {
  ReadTableKeys(object, config);
  return Settle(object, config);
}

Status ReadTableWorld(StrictObject object, MockTurntableConfig& config) {
  ReadField(object, "scale", config.scale);
  ReadField(object, "backlash_deg", config.backlash_deg);
  ReadField(object, "settle_amplitude_deg", config.settle_amplitude_deg);
  ReadField(object, "settle_frequency_hz", config.settle_frequency_hz);
  ReadField(object, "settle_ms", config.settle_ms);
  ReadField(object, "home_switch_deg", config.home_switch_deg);
  ReadField(object, "power_on_deg", config.power_on_deg);
  return Settle(object, config);
}

Status ReadCameraDevice(StrictObject object, MockCameraConfig& config) {
  ReadField(object, "serial", config.serial);
  ReadField(object, "readout_ms", config.readout_ms);
  ReadField(object, "first_frame_id", config.first_frame_id);
  config.reports_trigger =
      object.OptionalBoolean("reports_trigger").value_or(config.reports_trigger);
  return Settle(object, config);
}

Status ReadShutter(StrictObject object, MockCameraConfig& config) {
  ReadField(object, "reference_exposure_us", config.reference_exposure_us);
  ReadField(object, "trigger_latency_ms", config.trigger_latency_ms);
  ReadField(object, "blur_threshold_deg", config.blur_threshold_deg);
  ReadField(object, "blur_samples", config.blur_samples);
  if (const auto seed = object.OptionalInteger("noise_seed", 0, std::int64_t{1} << 53))
    config.noise_seed = static_cast<std::uint64_t>(*seed);
  return Settle(object, config);
}

}  // namespace turnlight::rig::sim
