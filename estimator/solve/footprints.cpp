#include "estimator/solve/footprints.h"

#include <algorithm>
#include <cmath>

#include "estimator/solve/kernel/tile_kernel.h"

namespace turnlight::estimator::solve {

std::vector<std::uint8_t> FootprintSamples(const observe::Observations& observations,
                                           const model::Reflectance& reflectance, int least,
                                           double aperture) {
  double half_width = model::LobeHalfWidth(reflectance.lobes[0]);
  for (const model::Lobe& lobe : reflectance.lobes)
    if (lobe.present()) half_width = std::min(half_width, model::LobeHalfWidth(lobe));
  std::vector<std::uint8_t> samples(observations.tiles());
  for (std::size_t tile = 0; tile < samples.size(); ++tile) {
    const double ratio = static_cast<double>(observations.tile_footprint[tile]) / half_width *
                         (aperture / observe::kAperture);
    // Below 0.2 the centre will do. Then as many Gauss points as keep the error of a Gaussian
    // lobe's mean below 1e-4 of its peak: 2 up to a ratio of 0.5, 3 up to 1.2, and on in
    // proportion.
    const int count = ratio < 0.2   ? least
                      : ratio < 0.5 ? 2
                                    : 2 + static_cast<int>(std::ceil(ratio / 1.2));
    samples[tile] = static_cast<std::uint8_t>(std::min(count, kernel::kMaxSamples));
  }
  return samples;
}

}  // namespace turnlight::estimator::solve
