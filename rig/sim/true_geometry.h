// Where the axis, the target and the angles of a simulated table really are, so that a calibration
// has something to find: in a simulation's section `geometry`. Left out, the axis is W's z axis,
// the target sits on W's origin, and the table turns by what it reports.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "base/result.h"
#include "base/strict_object.h"
#include "calib/rig_geometry.h"
#include "rig/sim/synthetic_config.h"

namespace turnlight::rig::sim {

// Lengths in the rig's length_unit. Keys as the members, all optional.
struct TrueGeometry {
  // The axis A in W: turned by a rotation vector in W's xy plane, -45..45 each; and where it meets
  // W's plane z = 0.
  std::array<double, 2> axis_tilt_deg{0.0, 0.0};
  std::array<double, 2> axis_offset{0.0, 0.0};
  // The target T in A: its origin, and a rotation vector, -180..180 each, after the motion's tilt.
  Eigen::Vector3d target_offset = Eigen::Vector3d::Zero();
  Eigen::Vector3d target_turn_deg = Eigen::Vector3d::Zero();
  double angle_scale = 1.0;       // true degrees per degree of the table, 0.5..2
  double angle_offset_deg = 0.0;  // -360..360
  // Root mean square of what the platter is off at an angle, 0..2: a sum of waves of the angle
  // drawn by the scene's seed, so that it is the same whenever the table comes back. Nothing known
  // of the rig has it.
  double angle_noise_deg = 0.0;
};

Status ReadTrueGeometry(StrictObject object, TrueGeometry& geometry);

// A table's true geometry, but for the angle noise. motion must be of a table.
calib::TurntableGeometry GeometryOf(const Motion& motion, const TrueGeometry& geometry);

// How far the platter is off at an angle.
double AngleNoiseDeg(const TrueGeometry& geometry, std::uint64_t seed, double angle_deg);

// A rotation vector's pose, without translation; degrees.
calib::Pose TurnBy(const Eigen::Vector3d& rotation_deg);

}  // namespace turnlight::rig::sim
