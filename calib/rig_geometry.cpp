#include "calib/rig_geometry.h"

#include <Eigen/Geometry>
#include <cmath>

#include "base/angles.h"

namespace turnlight::calib {
namespace {

RigPoses Place(const TurntableGeometry& rig, double angle_deg) {
  const double angle = DegToRad(rig.angle_scale * angle_deg + rig.angle_offset_deg);
  return {rig.X_WC, rig.X_WA * Turn(Eigen::Vector3d::UnitZ(), angle) * rig.X_AT};
}

RigPoses Place(const OrbitGeometry& rig, double angle_deg) {
  return {LookAtOrigin(DegToRad(angle_deg), DegToRad(rig.elevation_deg), rig.distance), rig.X_WT};
}

}  // namespace

RigPoses PosesAt(const RigGeometry& geometry, double angle_deg) {
  return std::visit([angle_deg](const auto& rig) { return Place(rig, angle_deg); }, geometry);
}

Pose LookAtOrigin(double azimuth, double elevation, double distance) {
  const Eigen::Vector3d outward(std::cos(elevation) * std::cos(azimuth),
                                std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
  Pose X_WC;
  X_WC.rotation.col(0) = Eigen::Vector3d(-std::sin(azimuth), std::cos(azimuth), 0.0);
  X_WC.rotation.col(2) = -outward;
  X_WC.rotation.col(1) = X_WC.rotation.col(2).cross(X_WC.rotation.col(0));
  X_WC.translation = distance * outward;
  return X_WC;
}

Pose Turn(const Eigen::Vector3d& axis, double angle) {
  return {Eigen::AngleAxisd(angle, axis).toRotationMatrix(), Eigen::Vector3d::Zero()};
}

}  // namespace turnlight::calib
