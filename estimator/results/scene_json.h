// Scenes as text: truth.json, which says what a scene is, and result.json, which says what an
// estimate found. Both serve as `render --params` and as `estimate --initial`. `file` is only for
// messages.
//
// truth.json:
//   {"lights": [{"direction": [x,y,z], "position": [x,y,z] or null, "intensity": 1.0,
//                "color": [r,g,b], "inverse_distance": 1e-3}],
//    "reflectance": {"model": "phong", "albedo": [r,g,b], "ambient": 0.1, "diffuse": 0.5,
//                    "specular": 0.3, "shininess": 40, "diffuse_model": "oren-nayar",
//                    "roughness_deg": 20},
//    "note": "..."}
// `color`, `inverse_distance`, `diffuse_model`, `roughness_deg` and `note` are optional, and keys
// that begin with "x-" are free. `model` is "phong", "blinn-phong", "beckmann", "ggx", or "lambert"
// or "none" for no specular part, in which case (or with `specular` 0) `shininess` may be left out
// or null. "beckmann" and "ggx" have "alpha" in its place, and "f0" (0 to 1; left out: F = 1). All
// lobes, one or two, may stand in "lobes": [{"model", "specular", "shininess" or "alpha", "f0"}]
// instead. "ambient_color" and "specular_color" are optional. A direction need not be exactly unit.
// People write this file: a key that is not listed is refused.
//
// Of a result.json only lights, model and reflectance are read, and keys that are not known are
// passed over: the rule is in result_json.h.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "base/result.h"
#include "base/strict_object.h"
#include "estimator/model/initial_guess.h"
#include "estimator/model/scene.h"

namespace turnlight::estimator::results {

// A whole scene, ready to be rendered. Fails (kInput): no reflectance, a light without intensity, a
// position and a direction (or a position and an inverse_distance) that disagree by more than 0.1
// degree (0.1 %), a zero direction, shininess outside [0.5, 1e5], anything negative.
Result<model::Scene> ParseScene(const std::string& text, const std::string& file);

// A start for the estimator: directions suffice. The direction wins over the position, whose length
// gives the distance; both from W's origin. The result.json of an earlier estimate is a full guess.
Result<model::InitialGuess> ParseInitialGuess(const std::string& text, const std::string& file);

// The text of a truth.json; ParseScene gives back the same bits in every number but roughness,
// which passes through degrees.
std::string TruthToJson(const model::Scene& scene, const std::string& note = "");

// Whether the lobes are more than the keys specular and shininess can say, and the list that says
// them: model, specular, shininess or alpha, f0.
bool NeedsLobeList(const model::Reflectance& reflectance);
nlohmann::ordered_json LobeList(const model::Reflectance& reflectance);

// The keys of `reflectance` above, read from an object; refusals are left in the object.
model::Reflectance ReadReflectance(StrictObject& object);

}  // namespace turnlight::estimator::results
