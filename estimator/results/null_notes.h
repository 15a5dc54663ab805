// Why values of result.json are null, where the estimator has not said it ("distance-unknown",
// "no-highlight", "not-determined").
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "estimator/estimate.h"

namespace turnlight::estimator::results {

// Notes on what is null whatever the sigmas are.
std::vector<Note> NotesOnNulls(const Estimate& estimate);

// The sigmas of a result that the data do not determine: "lights/0/direction_sigma_deg, ...", or
// nothing. Those whose absence has another reason are not in it.
std::string NullSigmas(const Estimate& estimate, const nlohmann::ordered_json& json);

}  // namespace turnlight::estimator::results
