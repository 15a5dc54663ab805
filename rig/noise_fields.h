// The key noise of the radiometry in rig-calibration.json. Internal to this folder.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>

#include "base/result.h"
#include "base/strict_object.h"
#include "rig/rig_calibration.h"

namespace turnlight::rig {

// Both what merges exposures and what weighs the pixels of sessions, and their covariance.
Status ReadSensorNoise(StrictObject object, RigCalibration& calibration);
// None if nobody told of the noise: what is not known is not written as if it were.
std::optional<nlohmann::ordered_json> PrintSensorNoise(const RigCalibration& calibration);

}  // namespace turnlight::rig
