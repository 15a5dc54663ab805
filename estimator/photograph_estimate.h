// A second look at pictures that no usual model explains: as photographs of a real surface, whose
// highlights tell the lights.
#pragma once

#include <functional>
#include <optional>

#include "base/result.h"
#include "estimator/model/keyframe_source.h"
#include "estimator/observe/photograph.h"
#include "estimator/select/refined.h"
#include "estimator/start/photograph_lights.h"
#include "estimator/start/sample.h"

namespace turnlight::estimator {

struct Photographed {
  observe::Photograph look;
  start::PhotographLights lights;
};

// What the pictures are as photographs; nothing where they are none. sample: of the usual search,
// while it is open whether a usual model explains the pictures; null: none does.
using PhotographAsked = std::function<Result<std::optional<Photographed>>(
    const model::ModelChoice& choice, const start::Sample* sample)>;

// Reads the keyframes once more. Nothing if there is no compact bright spot, if their lights leave
// less than real surfaces do or far more, or if with them a usual model explains the pictures down
// to their noise. Fails as the source does.
Result<std::optional<Photographed>> LookAtPhotographs(const model::KeyframeSource& keyframes,
                                                      const target::Geometry& geometry,
                                                      const calib::RayGrid& rays,
                                                      const model::ModelChoice& choice,
                                                      const start::Sample* sample,
                                                      const StopFlag* stop);

// Whether a photograph's lights leave clearly less of it than a usual fit (of `fitted`) does.
bool LeavesLess(const Photographed& photograph, const select::Refined& usual,
                const observe::Observations& fitted);

// A photograph's fit in the coordinates of other pixels of the same pictures, with the footprints
// and shadows that they ask for: for maps and pictures.
select::Refined OnOtherPixels(const select::Refined& refined, const observe::Observations& fitted,
                              const observe::Observations& others);

}  // namespace turnlight::estimator
