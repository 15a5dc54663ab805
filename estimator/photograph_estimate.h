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

// What the usual search knows: a sample that it found no lights for, while it is open whether a
// usual model explains the pictures; or the fit, in W, that it ended with. The other is null.
struct UsualSearch {
  const start::Sample* sample = nullptr;
  const model::Scene* fit = nullptr;
};

// What the pictures are as photographs; nothing where they are none.
using PhotographAsked = std::function<Result<std::optional<Photographed>>(
    const model::ModelChoice& choice, const UsualSearch& usual)>;

// Reads the keyframes once more. Nothing if there is no compact bright spot, if their lights leave
// less than real surfaces do or far more, if with them a usual model explains the pictures down to
// their noise, or if they do not leave clearly less than the usual fit does. Fails as the source
// does.
Result<std::optional<Photographed>> LookAtPhotographs(const model::KeyframeSource& keyframes,
                                                      const target::Geometry& geometry,
                                                      const calib::RayGrid& rays,
                                                      const model::ModelChoice& choice,
                                                      const UsualSearch& usual,
                                                      const StopFlag* stop);

// A photograph's fit in the coordinates of other pixels of the same pictures, with the footprints
// and shadows that they ask for: for maps and pictures.
select::Refined OnOtherPixels(const select::Refined& refined, const observe::Observations& fitted,
                              const observe::Observations& others);

}  // namespace turnlight::estimator
