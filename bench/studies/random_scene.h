// The generator of the random study: scene number i is a pure function of i.
//
// What is drawn (uniform unless said otherwise):
//   target      sphere of radius 50 (70 %), tilted board of 160 x 120 (15 %), lump with hollows,
//               depth 0.1..0.25 (15 %); mm
//   motion      sphere: the camera goes round, 6..20 views; else: the target turns on the table,
//               12..24 views (board tilted by 12..28 degrees). Elevation 15..55 degrees (board
//               40..65), distance 300..600
//   camera      200 x 150, the target fills 80 % of the height
//   lights      1..8 (board 1..3), a quarter distant, the others 4..30 target radii away
//               (logarithmic); zenith up to 85 degrees; intensities in a ratio of at most 5
//               (logarithmic)
//   material    Phong, shininess 20..300 (logarithmic), k_s 0.15..0.6, k_d 0.3..0.7, k_a 0.01..0.1,
//               albedo 0.2..0.9 per channel; Lambert (90 %) or Oren-Nayar of 10..30 degrees
//   sensor      16 bits linear (50 %), 8 bits linear (25 %), 8 bits sRGB (25 %), with a black level
//               that keeps the noise of dark pixels; noise 0 (25 %) or 0.1..1 % of white
//               (logarithmic)
//   exposure    the brightest pixel at 0.7..0.95 of white, in 15 % at 1.1..1.4 (clipped)
// Lights and material are drawn again until: any two lights are at least two lobe widths apart (the
// full width at half maximum of (r.v)^n), every highlight reaches 0.05 of white, and at least 4
// usable pixels of at least 2 views lie above its half maximum, unshadowed. The number of lights is
// kept; so more lights come with narrower lobes.
#pragma once

#include <cstdint>

#include "base/result.h"
#include "rig/sim/synthetic_config.h"

namespace turnlight::studies {

// Fails (kInput) if no lights fit after very many tries; that scene is left out.
Result<rig::sim::SyntheticConfig> RandomScene(std::uint64_t number);

}  // namespace turnlight::studies
