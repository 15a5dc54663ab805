// Changes to a scene from the command line: `--set shininess=80`, `--light "0,0,1,inf,1"`.
#pragma once

#include <string>

#include "base/result.h"
#include "estimator/model/scene.h"

namespace turnlight::app {

// "key=value" with one of the keys
//   model=phong|blinn-phong|none  albedo=r,g,b  ambient  diffuse  specular  shininess
//   roughness_deg                 light.N.intensity    N from 0
// Setting a roughness above 0 makes the diffuse part Oren-Nayar. Fails (kInput) on an unknown key
// (naming the nearest), a light that is not there, a value out of its range.
Status ApplySetting(const std::string& setting, estimator::model::Scene& scene);

// "x,y,z,distance,intensity": a direction of any length but 0, a distance from W's origin in the
// session's length unit or "inf", an intensity of at least 0.
Result<estimator::model::Light> ParseLight(const std::string& text);

}  // namespace turnlight::app
