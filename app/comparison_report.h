// What a comparison says: for people, as JSON, as JUnit's test cases.
#pragma once

#include <string>
#include <vector>

#include "base/comparison.h"
#include "base/junit.h"

namespace turnlight::app {

// One line if all is the same: how many quantities, and the one nearest to its limit. Otherwise a
// table of what is different, worst first, and of what was not judged.
std::string ComparisonText(const Comparison& comparison);

// {"format": "turnlight-comparison", "version": 1, "a", "b", "same", "comparisons": [{"what",
// "same",
//  "content_sha256", "quantities": [{"group", "name", "quantity", "a", "b", "difference", "sigmas",
//  "sigmas_limit", "allowed", "require", "verdict", "why", "remark"}]}]}; null
// is what there is not.
std::string ComparisonsToJson(const std::string& a, const std::string& b,
                              const std::vector<Comparison>& comparisons);

// One case for each quantity; groups are "results.light 1", "sessions.frame 3 (30.0 deg)".
std::vector<JunitCase> JunitCases(const std::vector<Comparison>& comparisons);

}  // namespace turnlight::app
