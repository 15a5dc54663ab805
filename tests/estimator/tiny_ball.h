// Pictures of a ball of radius 1 at W's origin, 64 x 48 pixels each, by the renderer alone: for
// tests that need keyframes and cannot wait.
#pragma once

#include <numbers>
#include <opencv2/core.hpp>
#include <vector>

#include "calib/camera_model.h"
#include "estimator/model/keyframe.h"
#include "estimator/target/geometry.h"
#include "estimator/target/renderer.h"
#include "tests/estimator/directions.h"

namespace turnlight::estimator {

// A camera that looks at W's origin, its picture's top towards +z.
inline calib::Pose LookingAtOrigin(const Eigen::Vector3d& from) {
  const Eigen::Vector3d forward = -from.normalized();
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  calib::Pose X_WC;
  X_WC.rotation << right, forward.cross(right), forward;
  X_WC.translation = from;
  return X_WC;
}

// A ball of radius 1, a camera and what it took.
struct BallStudio {
  calib::CameraModel camera;
  target::Geometry geometry{calib::TargetShape(calib::SphereShape{1.0})};
  calib::RayGrid rays{camera};
  std::vector<model::Keyframe> keyframes;

  BallStudio(int width, int height, double focal)
      : camera(calib::CameraModel::Pinhole(width, height, focal, focal, 0.5 * (width - 1),
                                           0.5 * (height - 1))) {}
};

struct TinyBall : BallStudio {
  // Views from 30 degrees above the horizon, evenly all around. noise: sigma of a value.
  TinyBall(const model::Scene& scene, int views, double noise = 0.0) : BallStudio(64, 48, 160.0) {
    for (int view = 0; view < views; ++view) {
      const double azimuth = 2.0 * std::numbers::pi * view / views;
      const double across = 8.4 * std::cos(DegToRad(30.0)), up = 8.4 * std::sin(DegToRad(30.0));
      model::Keyframe& keyframe = keyframes.emplace_back();
      keyframe.X_WC = LookingAtOrigin({across * std::cos(azimuth), across * std::sin(azimuth), up});
      target::Rendering rendering =
          target::Render(scene, geometry, rays, keyframe.X_WC, keyframe.X_WT);
      const RandomStream random(static_cast<std::uint64_t>(view), 4);
      std::uint64_t draw = 0;
      for (cv::Vec3f& pixel : rendering.radiance)
        for (int c = 0; c < 3; ++c) pixel[c] += static_cast<float>(noise * random.Normal(draw++));
      keyframe.image.radiance = rendering.radiance;
      keyframe.image.saturated = cv::Mat1b::zeros(rays.height(), rays.width());
      keyframe.mask = cv::Mat1b(rays.height(), rays.width(), std::uint8_t{255});
    }
  }
};

}  // namespace turnlight::estimator
