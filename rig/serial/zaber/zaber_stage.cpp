#include "rig/serial/zaber/zaber_stage.h"

#include <charconv>
#include <cmath>
#include <utility>

#include "base/format.h"

namespace turnlight::rig::serial::zaber {
namespace {

// Of the settings maxspeed and accel: speed = maxspeed / 1.6384 microsteps a second, acceleration =
// accel * 10000 / 1.6384 microsteps a second squared (ASCII protocol manual, "Units").
constexpr double kSpeedUnit = 1.6384;
constexpr double kAccelerationUnit = 1.6384e-4;
// Larger ones are no stage's, and its microsteps would not be whole numbers of a double.
constexpr double kLargestTurn = 1e12;

std::optional<double> NumberOf(const SettingValues& values, std::string_view name) {
  const auto found = values.find(name);
  return found == values.end() ? std::nullopt : ParseNumber(found->second);
}

std::string TextOf(const SettingValues& values, std::string_view name) {
  const auto found = values.find(name);
  return found == values.end() ? std::string() : found->second;
}

std::optional<double> Scaled(std::optional<double> value, double unit) {
  if (!value) return std::nullopt;
  return *value / unit;
}

// Above 0, or as if the device had not said it.
std::optional<double> Positive(std::optional<double> value) {
  return value && *value > 0.0 ? value : std::nullopt;
}

}  // namespace

ZaberOptions ReadZaberOptions(StrictObject& keys) {
  ZaberOptions options;
  if (const auto device = keys.OptionalInteger("device", 1, 99))
    options.device = static_cast<int>(*device);
  if (const auto axis = keys.OptionalInteger("axis", 1, 9)) options.axis = static_cast<int>(*axis);
  if (const auto turn = keys.OptionalInteger("microsteps_per_turn", 360, 1'000'000'000))
    options.microsteps_per_turn = static_cast<double>(*turn);
  return options;
}

Result<ZaberStage> IdentifyStage(const SettingValues& values, const ZaberOptions& options) {
  const auto cycle = Positive(NumberOf(values, "limit.cycle.dist"));
  const auto wanted = options.microsteps_per_turn;
  if (!cycle && !wanted)
    return DeviceError(
        Format("Zaber device %d (id %s), axis %d: has no limit.cycle.dist, so it is no rotary "
               "stage, or one "
               "that does not know its turn; if it is one, set microsteps_per_turn",
               options.device, TextOf(values, "device.id").c_str(), options.axis));
  if (cycle && wanted && *cycle != *wanted)
    return DeviceError(Format(
        "Zaber device %d, axis %d: turns by %s microsteps (limit.cycle.dist), microsteps_per_turn "
        "is %s",
        options.device, options.axis, NumberText(*cycle).c_str(), NumberText(*wanted).c_str()));
  const double turn = wanted ? *wanted : *cycle;
  if (!(turn <= kLargestTurn))
    return DeviceError("Zaber: limit.cycle.dist is " + NumberText(turn) + ", which is no turn");

  ZaberStage stage;
  stage.microsteps_per_deg = turn / 360.0;
  const std::string version = TextOf(values, "version");
  stage.identified.identity = {
      "Zaber",
      "device " + TextOf(values, "device.id") + (version.empty() ? "" : ", firmware " + version),
      TextOf(values, "system.serial")};
  StageTraits& traits = stage.identified.traits;
  traits.resolution_deg = 1.0 / stage.microsteps_per_deg;
  traits.min_deg = Scaled(NumberOf(values, "limit.min"), stage.microsteps_per_deg);
  traits.max_deg = Scaled(NumberOf(values, "limit.max"), stage.microsteps_per_deg);
  traits.max_speed_deg_s =
      Positive(Scaled(NumberOf(values, "maxspeed"), kSpeedUnit * stage.microsteps_per_deg));
  traits.acceleration_deg_s2 =
      Positive(Scaled(NumberOf(values, "accel"), kAccelerationUnit * stage.microsteps_per_deg));
  if (traits.min_deg && traits.max_deg && !(*traits.min_deg < *traits.max_deg))
    return DeviceError(Format("Zaber device %d, axis %d: limit.min %s is not below limit.max %s",
                              options.device, options.axis, TextOf(values, "limit.min").c_str(),
                              TextOf(values, "limit.max").c_str()));
  return stage;
}

std::optional<double> ParseNumber(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

}  // namespace turnlight::rig::serial::zaber
