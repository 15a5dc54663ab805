// What the user says about the model; what is absent the data decide.
#pragma once

#include <optional>

#include "estimator/model/scene.h"

namespace turnlight::estimator::model {

struct ModelChoice {
  std::optional<int> lights;  // 1 to 32
  std::optional<DiffuseModel> diffuse;
  std::optional<SpecularModel> specular;
  std::optional<int> lobes;  // 1 or 2, where there is a highlight
  std::optional<bool> near;  // all lights near, or all distant
  // Of all lights, from W's origin, in the session's unit; near is true then.
  DistanceRange distance;
  std::optional<bool> coloured;   // lights of their own colours, or all white
  std::optional<int> white;       // number, from 1, of the light that is said to be white
  std::optional<bool> changing;   // intensities of their own in each keyframe, or constant
  std::optional<bool> harmonics;  // ambient light that depends on the normal, or constant
};

}  // namespace turnlight::estimator::model
