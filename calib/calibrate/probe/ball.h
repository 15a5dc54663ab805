// The geometry of a mirror ball: what a pixel sees in it, and where it shows a light.
//
// All in W. A light is a direction u and an inverse distance rho from W's origin: from x it is seen
// along u - rho x.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "calib/camera_model.h"
#include "calib/pose.h"

namespace turnlight::calib::calibrate::probe {

struct Ball {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double radius = 1.0;  // above 0
};

struct Mirrored {
  Eigen::Vector3d point;      // of the ball's surface
  Eigen::Vector3d direction;  // unit, away from the ball, where the mirrored ray comes from
  double cosine = 0.0;        // of the angle between the normal and the way back to the camera
};

// Nothing where the ray (unit) misses the ball or is NaN.
std::optional<Mirrored> MirrorOnBall(const Ball& ball, const Eigen::Vector3d& origin,
                                     const Eigen::Vector3d& ray);

// A camera that looks at a ball. Camera and rays, which are that camera's, outlive it.
struct BallView {
  const CameraModel* camera = nullptr;
  const RayGrid* rays = nullptr;
  Pose X_WC;
  Ball ball;
};

// What an image point sees in the ball; the point lies at most half a pixel outside the picture.
std::optional<Mirrored> MirrorAt(const BallView& view, const Eigen::Vector2d& pixel);

// d direction / d pixel: 3 x 2, by central differences. Nothing near the outline.
std::optional<Eigen::Matrix<double, 3, 2>> MirrorDifferential(const BallView& view,
                                                              const Eigen::Vector2d& pixel);

// The point of the ball's surface that shows the light to an eye: its normal halves the angle
// between the two. Nothing if the ball hides it.
std::optional<Eigen::Vector3d> MirrorPoint(const Ball& ball, const Eigen::Vector3d& eye,
                                           const Eigen::Vector3d& u, double rho);

// Where in the picture the ball shows the light. Nothing if it does not.
std::optional<Eigen::Vector2d> PixelOfLight(const BallView& view, const Eigen::Vector3d& u,
                                            double rho);

// Pixels that the ball's radius spans, seen from the side.
double RadiusInPixels(const BallView& view);

// Two unit vectors across unit u.
Eigen::Matrix<double, 3, 2> Across(const Eigen::Vector3d& u);

}  // namespace turnlight::calib::calibrate::probe
