// The target's outlines in a session's pictures: what `calibrate target` and `calibrate check`
// need.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "base/result.h"
#include "calib/calibrate/placement/placement.h"
#include "rig/rig_calibration.h"
#include "rig/session/session.h"

namespace turnlight::app {

// Files of pictures beside the frames: none, one for all, or one each.
struct PicturesBeside {
  std::vector<std::string> empty, lamp_off;
};
// --empty and --lamp-off.
void AddBesideOptions(CLI::App& command, PicturesBeside& beside);

struct OutlinePictures {
  std::vector<calib::calibrate::placement::View> views;  // of all frames
  std::vector<cv::Mat> shown;  // pictures for the report; empty for the others
  std::vector<std::string> remarks;
  bool from_masks = false;  // some outlines are those of the session's masks
};

// Shows its progress, and writes masks into a folder that is named. Fails (kInput); kInterrupted.
Result<OutlinePictures> FindOutlines(const rig::Session& session, const PicturesBeside& beside,
                                     const std::filesystem::path& masks);

// Whether unit, size and angles are those of the calibration. Fails (kInput).
Status CheckOutlineSession(const rig::Session& session, const rig::RigCalibration& calibration);

}  // namespace turnlight::app
