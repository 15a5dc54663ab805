// The scene model forwards: what the camera would see of a target.
#pragma once

#include <opencv2/core.hpp>

#include "calib/camera_model.h"
#include "calib/pose.h"
#include "estimator/model/scene.h"
#include "estimator/target/geometry.h"

namespace turnlight::estimator::target {

struct RenderOptions {
  // A pixel is the mean over its footprint: samples_per_side^2 rays on a regular grid, 1..32.
  int samples_per_side = 5;
  bool cast_shadows = true;  // of the target on itself
};

struct Rendering {
  cv::Mat3f radiance;  // linear, R G B, h x w; background 0, a pixel on the outline is a mixture
  cv::Mat1f coverage;  // share of the pixel's footprint on the target, 0..1
};

// Deterministic for any number of threads.
Rendering Render(const model::Scene& scene, const Geometry& geometry, const calib::RayGrid& rays,
                 const calib::Pose& X_WC, const calib::Pose& X_WT,
                 const RenderOptions& options = {});

}  // namespace turnlight::estimator::target
