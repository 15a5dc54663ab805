// Where camera and target are when a rig's table reports an angle.
//
// Frames: W world, C camera, T target, A the table's axis: A's origin is on it and its z axis is
// along it. Positive angles are counter-clockwise seen from +z. Lengths in the session's unit.
#pragma once

#include <variant>

#include "calib/pose.h"

namespace turnlight::calib {

struct RigPoses {
  Pose X_WC;
  Pose X_WT;
};

// The camera stays, the target turns on the table:
//   X_WT = X_WA * Rz(angle_scale * angle + angle_offset) * X_AT
struct TurntableGeometry {
  Pose X_WC;
  Pose X_WA;
  Pose X_AT;
  double angle_scale = 1.0;  // true degrees per degree that the table reports; not 0
  double angle_offset_deg = 0.0;
};

// The target stays, the camera is carried round W's z axis: it looks at W's origin from an azimuth
// that is the angle, with its x axis level. This form, and not a rotation of a pose, keeps the
// camera's distance and its level exact at every angle.
struct OrbitGeometry {
  double elevation_deg = 0.0;  // of the camera above W's xy plane, -90..90
  double distance = 1.0;       // from W's origin, above 0
  Pose X_WT;
};

using RigGeometry = std::variant<TurntableGeometry, OrbitGeometry>;

// At the angle that the table reports; any finite number, not wrapped.
RigPoses PosesAt(const RigGeometry& geometry, double angle_deg);

// A camera at the given azimuth and elevation (radians) that looks at W's origin from a distance,
// its x axis level.
Pose LookAtOrigin(double azimuth, double elevation, double distance);

// A rotation about a unit axis, without translation; the angle in radians.
Pose Turn(const Eigen::Vector3d& axis, double angle);

}  // namespace turnlight::calib
