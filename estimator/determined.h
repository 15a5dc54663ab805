// What an estimate does not know: values whose sigma allows anything.
#pragma once

#include "base/result.h"
#include "estimator/estimate.h"
#include "estimator/observe/observations.h"

namespace turnlight::estimator {

// Nothing is known of a direction whose sigma is above this; of another value if its sigma is
// more than the value itself, and more than a share of what it could be: see determined.cpp.
inline constexpr double kUnknownDirectionDeg = 45.0;

// Takes what is not known out of an estimate that has sigmas: lights without a direction leave the
// list (note "light-left-out"), keys of other values are listed in `undetermined` (note
// "not-determined"). Fails (kNoEstimate) if the brightest light is without a direction: all others
// are relative to it. The sigmas stay.
Status LeaveOutUnknown(const observe::Observations& all, Estimate& out);

// Whether a key of result.json is listed, "reflectance/diffuse" for example.
bool IsUndetermined(const Estimate& estimate, const std::string& key);

}  // namespace turnlight::estimator
