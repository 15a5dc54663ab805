#include "rig/sim/true_geometry.h"

#include <cmath>
#include <numbers>
#include <variant>

#include "base/angles.h"
#include "base/random.h"
#include "rig/sim/studio.h"

namespace turnlight::rig::sim {
namespace {

constexpr double kMaxTiltDeg = 45.0;
constexpr double kMaxLength = 1e6;
constexpr std::uint64_t kAngleNoiseStream = 0x616E676C65;  // of a seed's, no other's
// Waves per turn: primes, so that steps of whole fractions of a turn do not meet the same phase.
constexpr std::array<int, 10> kWaves{7, 11, 13, 17, 19, 23, 29, 31, 37, 41};

void ReadVector(StrictObject& object, const char* key, double max, Eigen::Vector3d& value) {
  if (const auto list = object.OptionalNumbers(key, 3, {.min = -max, .max = max}))
    value = {(*list)[0], (*list)[1], (*list)[2]};
}

void ReadPair(StrictObject& object, const char* key, double max, std::array<double, 2>& value) {
  if (const auto list = object.OptionalNumbers(key, 2, {.min = -max, .max = max}))
    value = {(*list)[0], (*list)[1]};
}

void ReadInRange(StrictObject& object, const char* key, Range range, double& value) {
  value = object.OptionalNumber(key, range).value_or(value);
}

}  // namespace

Status ReadTrueGeometry(StrictObject object, TrueGeometry& geometry) {
  ReadPair(object, "axis_tilt_deg", kMaxTiltDeg, geometry.axis_tilt_deg);
  ReadPair(object, "axis_offset", kMaxLength, geometry.axis_offset);
  ReadVector(object, "target_offset", kMaxLength, geometry.target_offset);
  ReadVector(object, "target_turn_deg", 180.0, geometry.target_turn_deg);
  ReadInRange(object, "angle_scale", {.min = 0.5, .max = 2.0}, geometry.angle_scale);
  ReadInRange(object, "angle_offset_deg", {.min = -360.0, .max = 360.0}, geometry.angle_offset_deg);
  ReadInRange(object, "angle_noise_deg", {.min = 0.0, .max = 2.0}, geometry.angle_noise_deg);
  return object.Finish();
}

calib::Pose TurnBy(const Eigen::Vector3d& rotation_deg) {
  const double angle_deg = rotation_deg.norm();
  if (angle_deg == 0.0) return {};
  return calib::Turn(rotation_deg / angle_deg, DegToRad(angle_deg));
}

calib::TurntableGeometry GeometryOf(const Motion& motion, const TrueGeometry& geometry) {
  auto table = std::get<calib::TurntableGeometry>(GeometryOf(motion));
  table.X_WA = TurnBy({geometry.axis_tilt_deg[0], geometry.axis_tilt_deg[1], 0.0});
  table.X_WA.translation = {geometry.axis_offset[0], geometry.axis_offset[1], 0.0};
  calib::Pose placed = TurnBy(geometry.target_turn_deg);
  placed.translation = geometry.target_offset;
  table.X_AT = placed * table.X_AT;
  table.angle_scale = geometry.angle_scale;
  table.angle_offset_deg = geometry.angle_offset_deg;
  return table;
}

double AngleNoiseDeg(const TrueGeometry& geometry, std::uint64_t seed, double angle_deg) {
  if (geometry.angle_noise_deg == 0.0) return 0.0;
  const RandomStream random(seed, kAngleNoiseStream);
  double sum = 0.0;
  for (std::size_t i = 0; i < kWaves.size(); ++i)
    sum += std::cos(kWaves[i] * DegToRad(angle_deg) + 2.0 * std::numbers::pi * random.Uniform(i));
  return geometry.angle_noise_deg * sum * std::sqrt(2.0 / static_cast<double>(kWaves.size()));
}

}  // namespace turnlight::rig::sim
