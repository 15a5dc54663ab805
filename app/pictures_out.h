// The pictures of an estimate as files.
#pragma once

#include <filesystem>
#include <vector>

#include "base/result.h"
#include "calib/camera_model.h"
#include "estimator/estimate.h"
#include "estimator/model/keyframe.h"
#include "estimator/target/geometry.h"

namespace turnlight::app {

// Writes what estimator/pictures/pictures.h makes into the folder; gives the number of files.
Result<std::size_t> WritePictures(const std::vector<estimator::model::Keyframe>& keyframes,
                                  const estimator::target::Geometry& geometry,
                                  const calib::CameraModel& camera,
                                  const estimator::EstimateOutput& output,
                                  const std::filesystem::path& out);

}  // namespace turnlight::app
