// What a person wants to know of an estimate, on a page.
#pragma once

#include <string>

#include "estimator/estimate.h"

namespace turnlight::app {

// A value with its sigma, both to the same digit, of which the sigma has two: "700.1 +- 1.2" with
// the sign for plus or minus. A sigma that is 0 or not finite is left out.
std::string Measure(double value, double sigma);

// Several lines, each ended. length_unit is the session's.
std::string Summary(const estimator::Estimate& estimate, const std::string& session_name,
                    const std::string& length_unit);

}  // namespace turnlight::app
