// A virtual sphere of the estimated material in a photograph: where it stands and what it does to
// the picture.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "estimator/pictures/view.h"

namespace turnlight::estimator::pictures {

// normal . p = offset, all in W. Seen and shaded on the side of the normal only.
struct GroundPlane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double offset = 0.0;
};

struct VirtualSphere {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  // in W
  double radius = 1.0;
  // What it stands on besides the target, and casts its shadow on: nothing when it stands on the
  // target itself.
  std::optional<GroundPlane> ground;
};

// The ground under a sphere or mesh: perpendicular to W's +z through the target's lowest point.
// Where the camera does not look down on that plane at 5 to 75 degrees, W's +z is not "up" in the
// picture; then "up" is the picture's own, tilted 20 degrees towards the camera.
GroundPlane ChooseGround(const target::Geometry& geometry, const calib::Pose& X_WC,
                         const calib::Pose& X_WT);

// One sphere for each view; all views show the same camera, geometry and scene.
// On a plane target it stands on the target, at one place for all views: in view in as many as
// possible, off the middle, its shadows on the target, its body not before a highlight.
// Beside a sphere or mesh it stands on the ground, in each view at its left or right and as large
// as the picture has room for, at the side that more light reaches.
std::vector<VirtualSphere> PlaceSpheres(const std::vector<PictureView>& views);

// The photograph with the sphere in it. The sphere has the scene's material and lights, is hidden
// by the target where that is in front, and is shaded by it. Its shadow falls on the target, where
// the photograph is scaled by the model's radiance with over without the lights that the sphere
// hides, and on the ground, where the scale is that of a matte surface of the target's ambient and
// diffuse coefficients. So a shadow darkens what the photograph shows, texture and all, and falls
// on nothing where the photograph is black. Edges are smooth by sub-samples of each pixel. Pixels
// that neither sphere nor shadow touches keep their bits.
cv::Mat3f InsertSphere(const cv::Mat3f& photograph, const Matte& matte, const PictureView& view,
                       const VirtualSphere& sphere);

}  // namespace turnlight::estimator::pictures
