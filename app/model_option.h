// The model from the command line: `--model lights=2`, `--model specular=none`.
#pragma once

#include <string>

#include "base/result.h"
#include "estimator/model/model_choice.h"

namespace turnlight::app {

// "key=value" with one of
//   lights=1..32  diffuse=lambert|oren-nayar  specular=none|phong|blinn-phong
//   lights-are=near|distant
// Fails (kInput) on an unknown key or value, naming the nearest or what is allowed.
Status ApplyModelOption(const std::string& option, estimator::model::ModelChoice& choice);

}  // namespace turnlight::app
