// Pictures of something on a turning table, from a session or from a raw capture: what `calibrate
// axis` needs of either.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "calib/radiometry.h"
#include "rig/rig_calibration.h"

namespace turnlight::app {

struct TurningPictures {
  std::vector<double> angles_deg;  // as the table measured them, else as it was sent, in order
  // Grey, 8 or 16 bits.
  std::function<Result<cv::Mat>(std::size_t)> picture;
  cv::Size size;
  calib::Radiometry radiometry;
  std::optional<rig::CalibratedDevices> devices;  // a session does not know them
};

// Of a raw capture the frames of this kind, or those without a kind if it has none of it. Fails
// (kInput): neither a session nor a raw capture, no frame, a frame without an angle.
Result<TurningPictures> ReadTurningPictures(const std::filesystem::path& path,
                                            const std::string& kind);

}  // namespace turnlight::app
