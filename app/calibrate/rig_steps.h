// The steps of `turnlight calibrate rig`: each takes its raw captures, or finds them there, and
// makes of them what is known of the rig after it. What they write lies in a folder of its own
// each.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "app/calibrate/prop_stage.h"
#include "app/calibrate/rig_recipe.h"
#include "app/drivers.h"
#include "base/result.h"
#include "base/stop_flag.h"
#include "calib/calibrate/axis/calibrate_axis.h"
#include "calib/calibrate/lens/calibrate_lens.h"
#include "calib/calibrate/placement/placement.h"
#include "calib/calibrate/response/response.h"
#include "rig/rig_calibration.h"

namespace turnlight::app {

struct RigWork {
  const RigRecipe& recipe;
  const std::filesystem::path& out;
  PropStage& stage;
  const Drivers& drivers;
  bool asks = true;  // a person at a real rig
  const StopFlag* stop = nullptr;
  std::function<void(const std::string&)> say = [](const std::string&) {};
};

// DIR/response: response.json and charts. Nothing if the recipe has no response.
Result<std::optional<calib::calibrate::response::Response>> FindResponse(const RigWork& work);

// DIR/lens: camera.cameramodel, intrinsics.json, pages. verdict: in words.
struct LensFound {
  calib::calibrate::lens::LensCalibration calibration;
  std::string verdict;
};
Result<LensFound> FindLens(const RigWork& work);

// DIR/axis: pages. calibration: all that is known after it.
struct AxisFound {
  rig::RigCalibration calibration;
  calib::calibrate::axis::AxisCalibration axis;
};
Result<AxisFound> FindAxis(const RigWork& work, const LensFound& lens,
                           const std::optional<calib::calibrate::response::Response>& response);

// DIR/target: pages.
struct TargetFound {
  rig::RigCalibration calibration;  // whole
  calib::calibrate::placement::Placement placement;
};
Result<TargetFound> FindTarget(const RigWork& work, const AxisFound& axis);

}  // namespace turnlight::app
