// What the user says about the model; what is absent the data decide.
#pragma once

#include <optional>

#include "estimator/model/scene.h"

namespace turnlight::estimator::model {

struct ModelChoice {
  std::optional<int> lights;  // 1 to 32
  std::optional<DiffuseModel> diffuse;
  std::optional<SpecularModel> specular;
  std::optional<bool> near;      // all lights near, or all distant
  std::optional<bool> coloured;  // lights of their own colours, or all white
};

}  // namespace turnlight::estimator::model
