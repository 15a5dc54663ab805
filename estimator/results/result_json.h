// result.json, version 1, as text. Keys, and the rule for new ones: docs/design.md, section 8.
//
// The rule. Within version 1 a file may gain keys, never lose or reinterpret them. A new key is
// optional, docs/design.md lists it in the same change, and the other keys mean the same with or
// without it; so readers (scene_json.h) do without it, and pass over keys that they do not know.
// Whatever changes what another key means is version 2, which a reader of version 1 refuses. Keys
// that begin with "x-" are free.
#pragma once

#include <string>

#include "estimator/estimate.h"
#include "estimator/next_view.h"
#include "estimator/results/words.h"

namespace turnlight::estimator::results {

// Seconds, for people; outside of every comparison.
struct RunTimes {
  double load_s = 0.0;
  double total_s = 0.0;
};

// The file's text. Keys in the design's order; numbers read back to the same bits. What the data do
// not determine is null (Estimate::undetermined), and a note says why. `color` stands in a light
// only if it is not white, `roughness_deg` in the reflectance only for Oren-Nayar.
// "next_view" if it was asked for. "x-residual-history", of Method::kPaper only: the residual's rms
// at the start and after every iteration.
std::string ResultToJson(const Estimate& estimate, const std::string& session_name, Method method,
                         const RunTimes& times, const ViewAdvice* next_view = nullptr);

// The full width at half maximum of the highlight in degrees, in the angle between the mirror
// direction and the viewer. About the normal a lobe turns half as fast, hence it is twice as wide.
double LobeWidthDeg(const model::Lobe& lobe);

}  // namespace turnlight::estimator::results
