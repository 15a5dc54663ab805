// The model from the command line: `--model lights=2`, `--model specular=none`.
#pragma once

#include <string>

#include "base/result.h"
#include "estimator/model/model_choice.h"

namespace turnlight::estimator::results {

// "key=value" with one of
//   lights=1..32
//   diffuse=lambert|oren-nayar|coated
//   specular=none|phong|blinn-phong|beckmann|ggx
//   lights-are=near|distant
//   distance=A..B     all lights are so far from W's origin, 0 < A < B, in the session's unit, and
//                     near; or distance=D, known to a thousandth
//   color=free|white  whether lights have colours of their own
// Fails (kInput) on an unknown key or value, naming the nearest or what is allowed.
Status ApplyModelOption(const std::string& option, model::ModelChoice& choice);

// Keys and values, as a command's help lists them.
std::string ModelOptionHelp();

}  // namespace turnlight::estimator::results
