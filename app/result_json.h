// result.json, version 1 (design, section 8).
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "estimator/estimate.h"

namespace turnlight::app {

// Seconds, for people; outside of every comparison.
struct RunTimes {
  double load_s = 0.0;
  double total_s = 0.0;
};

// Keys in the design's order; numbers read back to the same bits. What the data do not determine is
// null, and a note says why. `color` stands in a light only if it is not white, `roughness_deg` in
// the reflectance only for Oren-Nayar. "x-residual-history", of method "paper" only: the residual's
// rms at the start and after every iteration.
nlohmann::ordered_json ResultToJson(const estimator::Estimate& estimate,
                                    const std::string& session_name, const std::string& method,
                                    const RunTimes& times);

// Why a solve ended, as "stopped" has it: "converged", "no-descent", "iteration-limit" or
// "not-finite".
const char* StoppedWord(estimator::solve::Stopped stopped);

// The full width at half maximum of the highlight in degrees, in the angle between the mirror
// direction and the viewer. Blinn-Phong's half-angle is half of that angle, hence twice as wide.
double LobeWidthDeg(const estimator::model::Reflectance& reflectance);

}  // namespace turnlight::app
