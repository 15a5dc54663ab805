// One keyframe as the pictures need it, and what the model says about it.
#pragma once

#include <opencv2/core.hpp>

#include "calib/camera_model.h"
#include "calib/pose.h"
#include "estimator/model/scene.h"
#include "estimator/target/geometry.h"

namespace turnlight::estimator::pictures {

struct PictureView {
  const model::Scene& scene;
  const target::Geometry& geometry;
  const calib::CameraModel& camera;
  const calib::RayGrid& rays;  // of the camera
  calib::Pose X_WC;
  calib::Pose X_WT;
  int samples_per_side = 4;  // of a pixel, for everything that is drawn into a photograph
};

// A picture taken apart at the target's outline, where pixels are mixtures:
// picture = coverage * target + (1 - coverage) * background. Without this, whatever is put in front
// of or behind the outline would carry a seam of the other side.
struct Matte {
  cv::Mat3f target;      // 0 where coverage is 0
  cv::Mat3f background;  // 0 where coverage is 1
  cv::Mat1f coverage;
};

// The background of a mixed pixel is the mean of the pure background within 4 pixels, weighted by
// nearness; the target is what then remains. Pure background has coverage 0 and is not in the mask
// of the target (non-zero = target; empty: not known): pixels within 3 of the modelled outline that
// the mask gives to the target are the photograph's own outline, where that is not quite the
// model's, and get a background from nearby too.
Matte TakeApart(const cv::Mat3f& picture, const cv::Mat1f& coverage, const cv::Mat1b& mask = {});

// The target as the model shows it, over the background of the photograph.
cv::Mat3f Relit(const Matte& matte, const cv::Mat3f& modelled);

}  // namespace turnlight::estimator::pictures
