#include "rig/sim/walk.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/angles.h"
#include "base/random.h"
#include "calib/calibrate/board/board_words.h"

namespace turnlight::rig::sim {
namespace {

// The share of a step in which the camera moves.
constexpr double kMovingShare = 0.6;
// Rounds that a part of the sway takes: it is another one in the next round.
constexpr double kSlow = 1.3, kFast = 3.7;

// From -1 to 1, smooth.
double Sway(const Walk& walk, std::uint64_t which, double walked_deg) {
  const RandomStream random(walk.seed, which);
  const auto wave = [&](std::uint64_t i, double waves) {
    return std::sin(waves * DegToRad(walked_deg) + random.Uniform(i, 0.0, 2.0 * std::numbers::pi));
  };
  return 0.6 * wave(0, kSlow) + 0.4 * wave(1, kFast);
}

}  // namespace

Result<Walk> ReadWalk(StrictObject object) {
  Walk walk;
  const auto number = [&object](const char* key, Range range, double& value) {
    value = object.OptionalNumber(key, range).value_or(value);
  };
  const StrictObject board = object.Object("board");
  ReadLook(object, walk.look);
  if (const auto at = object.OptionalNumbers("at", 3, {.min = -1e6, .max = 1e6}))
    walk.at = {(*at)[0], (*at)[1], (*at)[2]};
  number("turn_deg", {.min = -360.0, .max = 360.0}, walk.turn_deg);
  walk.seed = static_cast<std::uint64_t>(
      object.OptionalInteger("seed", 0, std::int64_t{1} << 53).value_or(1));
  number("speed_deg_s", {.max = 360.0, .above = 0.0}, walk.speed_deg_s);
  number("step_s", {.max = 60.0, .above = 0.0}, walk.step_s);
  number("sway_deg", {.min = 0.0, .max = 45.0}, walk.sway_deg);
  number("distance_share", {.min = 0.0, .max = 0.5}, walk.distance_share);
  number("roll_deg", {.min = 0.0, .max = 90.0}, walk.roll_deg);
  if (const Status status = object.Finish(); !status) return Forward(status);
  auto read = calib::calibrate::board::ReadBoard(board);
  if (!read) return Forward(read);
  walk.board = std::move(*read);
  return walk;
}

double WalkedDeg(const Walk& walk, DeviceTime time) {
  const double steps = std::max(0.0, static_cast<double>(time.count()) * 1e-9 / walk.step_s);
  const double moved = std::min(1.0, (steps - std::floor(steps)) / kMovingShare);
  const double smooth = moved * moved * (3.0 - 2.0 * moved);
  return walk.speed_deg_s * walk.step_s * (std::floor(steps) + smooth);
}

calib::RigPoses PosesOf(const Walk& walk, const calib::OrbitGeometry& orbit, double walked_deg) {
  const double elevation_deg = orbit.elevation_deg + walk.sway_deg * Sway(walk, 0, walked_deg);
  const double distance = orbit.distance * (1.0 + walk.distance_share * Sway(walk, 1, walked_deg));
  const calib::Pose upright =
      calib::LookAtOrigin(DegToRad(walked_deg), DegToRad(elevation_deg), distance);
  const calib::Pose roll =
      calib::Turn(Eigen::Vector3d::UnitZ(), DegToRad(walk.roll_deg * Sway(walk, 2, walked_deg)));
  calib::Pose X_WT = calib::Turn(Eigen::Vector3d::UnitZ(), DegToRad(walk.turn_deg));
  X_WT.translation = walk.at;
  return {upright * roll, X_WT * orbit.X_WT};
}

}  // namespace turnlight::rig::sim
