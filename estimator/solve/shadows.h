// Shadows in the fit: which of the scene's lights each observation sees, and which pixels lie on an
// edge of a shadow, cast or attached, where shading at the pixel's centre is not its mean. That
// does not change smoothly with the parameters, so it is held while the solver runs and found
// again from where it stopped.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "estimator/model/scene.h"
#include "estimator/observe/observations.h"

namespace turnlight::estimator::solve {

// A pixel mask: one byte per observation, 1 or 0.
using PixelMask = std::shared_ptr<const std::vector<std::uint8_t>>;

struct Shadows {
  std::vector<model::Light> lights;  // what the masks were cast from
  // Per light, empty if the target cannot shadow itself. Neither lit nor blocked: faces away.
  std::vector<PixelMask> lit;
  std::vector<PixelMask> blocked;  // faces the light, but something stands in between
  PixelMask usable;                // 0: on a shadow's edge; null: not looked for
  std::size_t left_out = 0;        // zeros of usable that are not filling
};

// Casts the shadows of a scene (in the observations' coordinates). A light that stands within
// `tolerance` (radians, and 1/R of inverse distance) of one of `previous` keeps its masks. Edges
// are not looked for in a subsample: with the many lights of a start they would be everywhere.
// Deterministic for any number of threads.
Shadows CastShadows(const observe::Observations& observations, const model::Scene& scene,
                    const Shadows& previous = {}, double tolerance = 0.0);

// Which observations have no attached shadow's edge near: within `margin` half footprints.
PixelMask AwayFromTerminators(const observe::Observations& observations,
                              const std::vector<model::Light>& lights, double margin);

// Whether two casts make the same model of the pictures.
bool SameShadows(const Shadows& a, const Shadows& b);

}  // namespace turnlight::estimator::solve
