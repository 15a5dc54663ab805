// Which pictures a raw capture is to have, in order, and which of them it has.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "rig/capture/capture_plan.h"
#include "rig/session/raw_capture.h"

namespace turnlight::app {

// What is ordered beside the plan of a config's section capture.
struct RawOrder {
  std::string kind = "board";        // what the pictures show; a word of letters, digits, - and _
  std::vector<double> exposures_us;  // at each angle; empty: the plan's
  int pairs = 0;                     // two pictures so often for each exposure; 0: one picture
  bool move = true;                  // turn the table through the plan's angles
  int count = 1;                     // without: so many pictures where it stands
  bool ask = false;                  // wait for Enter before each count
};

struct PlannedPicture {
  std::string image;                // frames/KIND_000.png
  std::optional<double> angle_deg;  // none: the table is left alone
  rig::CameraSettings settings;
};

// By angle, then exposure, then repetition. extension: of the pictures, ".png".
std::vector<PlannedPicture> PlanPictures(const rig::CapturePlan& plan, const RawOrder& order,
                                         const std::string& extension);

// The frames of a capture that are the planned pictures and whole on the disk, by the plan's
// indices; nothing where a picture is missing or damaged. Fails (kInput) if a frame of a planned
// name is of another angle, exposure or gain: it is another capture's.
Result<std::vector<std::optional<rig::RawCaptureFrame>>> KeptFrames(
    const rig::RawCapture& capture, const std::vector<PlannedPicture>& plan);

}  // namespace turnlight::app
