// The pictures of an estimate as files.
#pragma once

#include <filesystem>

#include "base/result.h"
#include "calib/camera_model.h"
#include "estimator/estimate.h"
#include "estimator/model/keyframe_source.h"
#include "estimator/target/geometry.h"

namespace turnlight::app {

// Writes what estimator/pictures/pictures.h makes into the folder; gives the number of files. Fails
// as the source does, and if a file cannot be written.
Result<std::size_t> WritePictures(const estimator::model::KeyframeSource& keyframes,
                                  const estimator::target::Geometry& geometry,
                                  const calib::CameraModel& camera,
                                  const estimator::EstimateOutput& output,
                                  const std::filesystem::path& out);

}  // namespace turnlight::app
