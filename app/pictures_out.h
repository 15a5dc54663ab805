// The pictures of an estimate as files.
#pragma once

#include <filesystem>
#include <vector>

#include "base/result.h"
#include "calib/camera_model.h"
#include "estimator/estimate.h"
#include "estimator/geometry.h"
#include "estimator/keyframe.h"

namespace turnlight::app {

// Writes what estimator/pictures.h makes into the folder; gives the number of files.
Result<std::size_t> WritePictures(const std::vector<estimator::Keyframe>& keyframes,
                                  const estimator::Geometry& geometry,
                                  const calib::CameraModel& camera,
                                  const estimator::EstimateOutput& output,
                                  const std::filesystem::path& out);

}  // namespace turnlight::app
