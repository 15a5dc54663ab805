// The key `correlation` of result.json: docs/design.md, section 8.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>

#include "estimator/estimate.h"

namespace turnlight::estimator::results {

// {"names": [...], "sigmas": [...], "matrix": [[...]]}, correlations to four decimals. Nothing of
// no rows, or of more than uncertainty::kMostCorrelated.
std::optional<nlohmann::ordered_json> CorrelationToJson(
    const uncertainty::Correlation& correlation);

}  // namespace turnlight::estimator::results
