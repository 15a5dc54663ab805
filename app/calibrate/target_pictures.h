// Pictures of the target on a turning table, with those of the empty table and of lamps that are
// off: what `calibrate target` needs of a session or of a raw capture.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "calib/calibrate/placement/view_of_picture.h"
#include "calib/target_shape.h"
#include "rig/rig_calibration.h"
#include "rig/session/raw_capture.h"

namespace turnlight::app {

struct TargetPicture {
  double angle_deg = 0.0;  // as the table measured it, else as it was sent
  std::string label;       // as messages about it begin
};

struct TargetPictures {
  std::vector<TargetPicture> frames;
  // Linear radiance; companions and mask where there are any.
  std::function<Result<calib::calibrate::placement::Pictures>(std::size_t)> read;
};

// Picture files beside the frames: none, one for all, or one for each.
struct CompanionFiles {
  std::vector<std::string> empty, lamp_off;
};

// Of a session; its masks are used, its poses are not. Fails (kInput): another unit or resolution
// than the calibration's, a frame without an angle, a number of companions that does not fit.
Result<TargetPictures> TargetPicturesOf(const std::filesystem::path& session,
                                        const rig::RigCalibration& calibration,
                                        const CompanionFiles& companions);

// Of a raw capture: its frames of the kind target, or those without a kind. What is of the kinds
// empty and lamp-off is their companion: those at the frame's angle, or else the mean of all. Files
// count in place of those. The radiometry is the calibration's. Fails (kInput) as above, and if
// the devices are not those of the calibration.
Result<TargetPictures> TargetPicturesOf(const rig::RawCapture& capture,
                                        const rig::RigCalibration& calibration,
                                        const CompanionFiles& companions);

}  // namespace turnlight::app
