// The key next_view of result.json.
#pragma once

#include <nlohmann/json.hpp>

#include "estimator/next_view.h"

namespace turnlight::estimator::results {

// Keys as docs/design.md, section 8, has them. What there is not is null.
nlohmann::ordered_json NextViewToJson(const ViewAdvice& advice);

}  // namespace turnlight::estimator::results
