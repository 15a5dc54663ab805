// What is measured against what is expected, linearised. Internal to this folder and to drift.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <vector>

#include "calib/calibrate/placement/placement.h"

namespace turnlight::calib::calibrate::placement {

class ContourFinder;

struct State {
  calib::Pose X_AT;
  double radius = 0.0;
  double edge_offset = 0.0;
};

// Where each parameter stands: w, d, radius, edge offset.
inline constexpr int kParameters = 8, kRadius = 6, kEdgeOffset = 7;
using Row = Eigen::Matrix<double, 1, kParameters>;

struct Residual {
  std::size_t view = 0;
  Eigen::Vector2d pixel, normal;
  double value = 0.0;  // pixels, measured minus expected along the normal
  double sigma = 1.0;
  bool valid = false;  // false: the expected outline is nowhere near
  Eigen::RowVector3d by_p_C = Eigen::RowVector3d::Zero();  // d value / d (the outline's point in C)
  Eigen::Vector3d p_A = Eigen::Vector3d::Zero();           // that point
  double by_radius = 0.0;
  bool edge = true;  // false: a picked point, which has no edge offset
};

// How far from a measured point its part of the outline is looked for, in pixels.
using Model = std::function<std::vector<Residual>(const State&, double reach)>;

// Camera and table at a view's angle.
calib::Pose PoseOfTableInCamera(const calib::TurntableGeometry& geometry,
                                double angle_deg);  // X_CA

// d value / d parameters.
Row ParameterRow(const Residual& residual, const State& state, const calib::Pose& X_CA);

// Tangent rays of a sphere: the angle between a ray and the centre is asin(radius / distance).
Model SphereModel(const rig::RigCalibration& calibration, const std::vector<View>& views);

// The nearest part of the shape's contour whose normal agrees.
Model ContourModel(const rig::RigCalibration& calibration, const calib::TargetShape& shape,
                   const std::vector<View>& views);
// Of a shape whose edges are known already.
Model ContourModel(const rig::RigCalibration& calibration,
                   std::shared_ptr<const ContourFinder> finder, const std::vector<View>& views);

// Reprojection, two residuals each.
Model PickedModel(const rig::RigCalibration& calibration, const std::vector<View>& views,
                  const std::vector<PickedPoint>& picked, double sigma);

}  // namespace turnlight::calib::calibrate::placement
