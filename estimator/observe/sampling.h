// Fewer pixels, for what needs not all of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "estimator/observe/observations.h"

namespace turnlight::estimator::observe {

// A subset of about `count` pixels, in order, in one run of tiles, for starts. A pixel is picked
// with a probability that grows with its gradient along the row (sharp highlights are few pixels),
// by a random number that is a function of (seed, index) only.
Observations Subsample(const Observations& all, std::size_t count, std::uint64_t seed);

// As Subsample, but every pixel that is usable (null: all) with the same probability: a gradient in
// a noisy picture is larger where the noise is, and what is picked by it has a mean.
Observations EvenSubsample(const Observations& all, std::size_t count, std::uint64_t seed,
                           const std::vector<std::uint8_t>* usable);

// The same, and the keyframe of each of its pixels (of filling, 0).
struct PixelSample {
  Observations pixels;
  std::vector<std::uint32_t> keyframe;
};
PixelSample SampleOfKeyframes(const Observations& all, std::size_t count, std::uint64_t seed,
                              const std::vector<std::uint8_t>* usable);

}  // namespace turnlight::estimator::observe
