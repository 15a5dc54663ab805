// What a calibration may have wrong, as far as an estimate needs to know: in which ways, each one
// sigma long, and what the keyframes would be with it a little elsewhere.
#pragma once

#include <cstddef>
#include <functional>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "calib/camera_model.h"
#include "calib/rig_geometry.h"
#include "estimator/uncertainty/budget.h"

namespace turnlight::estimator {

// The keyframes with the calibration moved.
struct MovedCalibration {
  std::vector<calib::RigPoses> poses;      // of each keyframe
  std::optional<calib::CameraModel> lens;  // none: as it was
  // The radiance of a keyframe (as model::Keyframe's); none: as they were. Called from several
  // threads.
  std::function<Result<cv::Mat>(std::size_t keyframe)> radiance;
};

struct CalibrationErrors {
  struct Item {
    uncertainty::BudgetWords words;
    std::size_t directions = 0;  // independent of each other and of the other items'
  };
  std::vector<Item> items;
  // The calibration moved along an item's direction by so many sigmas.
  std::function<MovedCalibration(std::size_t item, std::size_t direction, double sigmas)> move;
};

}  // namespace turnlight::estimator
