// A simulated session whose target is a mirror ball, on disk.
#pragma once

#include <filesystem>

#include "tests/calib/calibrate/probe/ball_pictures.h"

namespace turnlight::calib::calibrate::probe {

// 16-bit pictures, with masks if asked for. The session says that the ball is `off` from where it
// is.
void WriteBallSession(const BallPictures& pictures, bool masks, const Eigen::Vector3d& off,
                      const std::filesystem::path& folder);

}  // namespace turnlight::calib::calibrate::probe
