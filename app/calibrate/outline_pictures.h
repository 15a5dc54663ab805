// The target's outlines in the pictures of a session or a raw capture: what `calibrate target` and
// `calibrate check` need.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "app/calibrate/target_option.h"
#include "app/calibrate/target_pictures.h"
#include "base/result.h"
#include "calib/calibrate/placement/placement.h"
#include "calib/target_shape.h"
#include "rig/rig_calibration.h"

namespace turnlight::app {

struct TargetArguments {
  std::string pictures;  // a session or a raw capture
  TargetWords shape;     // of a raw capture's target
  CompanionFiles companions;
};
// --sphere, --plane, --mesh, --empty and --lamp-off.
void AddTargetOptions(CLI::App& command, TargetArguments& arguments);

struct TargetInput {
  TargetPictures pictures;
  calib::TargetShape shape;
};
// A session says itself what its target is; of a raw capture the options do. Fails (kInput) as
// TargetPicturesOf, and if shapes are named twice or not at all.
Result<TargetInput> ReadTargetInput(const TargetArguments& arguments,
                                    const rig::RigCalibration& calibration);

struct OutlinePictures {
  std::vector<calib::calibrate::placement::View> views;  // of all frames
  std::vector<cv::Mat> shown;  // pictures for the report; empty for the others
  std::vector<std::string> remarks;
  bool from_masks = false;  // some outlines are those of the session's masks
};

// Shows its progress, and writes masks into a folder that is named. Fails (kInput); kInterrupted.
Result<OutlinePictures> FindOutlines(const TargetPictures& pictures,
                                     const std::filesystem::path& masks);

}  // namespace turnlight::app
