// Pictures of a ball of radius 1 at W's origin as photographs are: the diffuse part departs from
// every model by smooth texture, highlights are sharp and clipped at 1. By the renderer, for tests
// of what photographs are searched with; real ones are in independent_photographs_test.
#pragma once

#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>
#include <vector>

#include "calib/camera_model.h"
#include "estimator/model/keyframe_source.h"
#include "estimator/target/renderer.h"
#include "tests/estimator/tiny_ball.h"

namespace turnlight::estimator {

// Distant lights on a glossy ball: Lambert under a coat, a sharp and a broad lobe.
inline model::Scene GlossyScene(const std::vector<Eigen::Vector3d>& directions) {
  model::Scene scene;
  model::Reflectance& r = scene.reflectance;
  r.albedo = {0.9, 1.0, 0.8};
  r.diffuse = 0.25;
  r.diffuse_model = model::DiffuseModel::kCoated;
  r.lobes[0] = {model::SpecularModel::kGgx, 0.05, 0.04, 1.0};
  r.lobes[1] = {model::SpecularModel::kGgx, 0.03, 0.15, 1.0};
  for (const Eigen::Vector3d& direction : directions) {
    model::Light light;
    light.direction = direction.normalized();
    scene.lights.push_back(light);
  }
  return scene;
}

struct PhotographBall : BallStudio {
  // Seen from +x first, then from evenly all around. texture: the amplitude of what no model has.
  explicit PhotographBall(const model::Scene& scene, int views = 1, double texture = 0.02)
      : BallStudio(128, 112, 420.0) {
    for (int view = 0; view < views; ++view) {
      const double azimuth = 2.0 * std::numbers::pi * view / views;
      model::Keyframe& keyframe = keyframes.emplace_back();
      keyframe.X_WC = LookingAtOrigin({8.4 * std::cos(azimuth), 8.4 * std::sin(azimuth), 0.0});
      const target::Rendering rendering =
          target::Render(scene, geometry, rays, keyframe.X_WC, keyframe.X_WT);
      cv::Mat3f radiance = rendering.radiance.clone();
      keyframe.image.saturated = cv::Mat1b::zeros(rays.height(), rays.width());
      const RandomStream random(static_cast<std::uint64_t>(view), 5);
      std::uint64_t draw = 0;
      for (int y = 0; y < radiance.rows; ++y)
        for (int x = 0; x < radiance.cols; ++x)
          for (int c = 0; c < 3; ++c) {
            float& value = radiance(y, x)[c];
            value *= static_cast<float>(1.0 + texture * std::sin(0.11 * x) * std::cos(0.13 * y));
            value += static_cast<float>(0.0005 * random.Normal(draw++));
            if (value < 1.0f) continue;
            value = 1.0f;
            keyframe.image.saturated(y, x) = 255;
          }
      keyframe.image.radiance = radiance;
      keyframe.mask = cv::Mat1b(rays.height(), rays.width(), std::uint8_t{255});
    }
  }

  model::KeyframeSource source() const { return model::SourceOf(keyframes); }
};

// The angle to the nearest of them, degrees.
inline double NearestDeg(const Eigen::Vector3d& direction,
                         const std::vector<Eigen::Vector3d>& others) {
  double best = 180.0;
  for (const Eigen::Vector3d& other : others)
    best = std::min(best, AngleDeg(direction.normalized(), other.normalized()));
  return best;
}

}  // namespace turnlight::estimator
