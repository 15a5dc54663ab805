// How finely the highlight is sampled within a pixel.
#pragma once

#include <cstdint>
#include <vector>

#include "estimator/model/scene.h"
#include "estimator/observe/observations.h"
#include "estimator/observe/trace_pixels.h"

namespace turnlight::estimator::solve {

// How finely each tile's footprint must be sampled for the narrowest of the lobes: the mirrored
// ray's change across the pixel against the lobe's half-width (design, section 2). least: 1 or 2.
// Where the centre would do, shininess is off by up to 0.5 % with 1, which for a start is good
// enough.
std::vector<std::uint8_t> FootprintSamples(const observe::Observations& observations,
                                           const model::Reflectance& reflectance, int least = 1,
                                           double aperture = observe::kAperture);

}  // namespace turnlight::estimator::solve
