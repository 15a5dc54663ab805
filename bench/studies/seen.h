// What the views of a config see: which highlights, how bright.
#pragma once

#include <memory>
#include <vector>

#include "base/result.h"
#include "calib/pose.h"
#include "estimator/model/scene.h"
#include "estimator/target/geometry.h"
#include "rig/sim/synthetic_config.h"

namespace turnlight::studies {

// A pixel that the estimator can use, in W.
struct SeenPixel {
  Eigen::Vector3d position, normal, mirrored;  // mirrored: the view direction about the normal
  int view = 0;
};

// The usable pixels of all views, whatever the lights.
class SeenSurface {
 public:
  // The config's lights and reflectance do not matter.
  static Result<SeenSurface> Build(const rig::sim::SyntheticConfig& config);

  const std::vector<SeenPixel>& pixels() const { return pixels_; }

  // In how many views at least min_pixels pixels lie above the half maximum of a light's highlight.
  int ViewsOfHighlight(const estimator::model::Light& light, double shininess,
                       int min_pixels) const;

  // The largest radiance of any channel, cast shadows left out of account.
  double Brightest(const estimator::model::Scene& scene) const;

  // The largest specular part that a light makes anywhere, in units of radiance.
  double HighlightPeak(const estimator::model::Scene& scene,
                       const estimator::model::Light& light) const;

 private:
  bool Shadowed(const SeenPixel& pixel, const Eigen::Vector3d& to_light, double distance) const;

  std::vector<SeenPixel> pixels_;
  std::shared_ptr<const estimator::target::Geometry> geometry_;
  std::vector<calib::Pose> X_WT_;  // per view
};

}  // namespace turnlight::studies
