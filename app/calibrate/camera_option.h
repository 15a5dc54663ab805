// A calibrated lens, as a command's option names it.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>

#include "base/result.h"
#include "calib/camera_model.h"

namespace turnlight::app {

struct CalibratedLens {
  calib::CameraModel camera;
  std::optional<Eigen::MatrixXd> covariance;  // of the intrinsics
};

// A .cameramodel, or the folder that `calibrate intrinsics` wrote: camera.cameramodel and, for the
// covariance, intrinsics.json, which has the model's checksum. Fails (kInput).
Result<CalibratedLens> ReadCalibratedLens(const std::filesystem::path& path);

}  // namespace turnlight::app
