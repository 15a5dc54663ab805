// Values that session.json shares with a rig's calibration and a run's config: the same keys, read
// and printed by the same words.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "base/result.h"
#include "base/strict_object.h"
#include "calib/pose.h"
#include "calib/radiometry.h"
#include "rig/session/session.h"

namespace turnlight::rig {

// The readers leave their refusals in the object; Finish is the caller's.

// encoding, black, white, saturation, reference_exposure_us, reference_gain_db, white_balance,
// vignetting. The status is that of an object below them.
Status ReadRadiometry(StrictObject& object, calib::Radiometry& radiometry);
// noise, which is optional.
Status ReadNoise(StrictObject& object, calib::Radiometry& radiometry);
nlohmann::ordered_json PrintVignetting(const calib::Vignetting& vignetting);
nlohmann::ordered_json PrintNoise(const calib::NoiseModel& noise);
// The three of them that are always there: encoding, black, white; and saturation if it is given.
nlohmann::ordered_json PrintRadiometryCore(const calib::Radiometry& radiometry);

// [[3 rows of 4]], a rigid transform.
calib::Pose ReadPose(StrictObject& object, const std::string& key);
nlohmann::ordered_json PrintPose(const calib::Pose& pose);

// {"shape": "sphere", "radius"}, {"shape": "plane", "size", "sides"} or {"shape": "mesh", "path"}.
Target ReadTargetKeys(StrictObject& object);

// 64 lower-case hexadecimal digits.
bool IsSha256(const std::string& text);
// Without spaces, such as a length unit.
bool IsWord(const std::string& text);

}  // namespace turnlight::rig
