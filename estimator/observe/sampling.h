// Fewer pixels, for what needs not all of them. Those of a subset are in one run of tiles, or
// (by_keyframe) in a run for each keyframe, as where lights change from one to the next.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "estimator/observe/observations.h"

namespace turnlight::estimator::observe {

// A subset of about `count` pixels, in order, for starts. A pixel is picked
// with a probability that grows with its gradient along the row (sharp highlights are few pixels),
// by a random number that is a function of (seed, index) only.
Observations Subsample(const Observations& all, std::size_t count, std::uint64_t seed,
                       bool by_keyframe = false);

// As Subsample, but every pixel that is usable (null: all) with the same probability: a gradient in
// a noisy picture is larger where the noise is, and what is picked by it has a mean.
Observations EvenSubsample(const Observations& all, std::size_t count, std::uint64_t seed,
                           const std::vector<std::uint8_t>* usable, bool by_keyframe = false);

// The same, and the keyframe of each of its pixels (of filling, 0).
struct PixelSample {
  Observations pixels;
  std::vector<std::uint32_t> keyframe;
};
PixelSample SampleOfKeyframes(const Observations& all, std::size_t count, std::uint64_t seed,
                              const std::vector<std::uint8_t>* usable, bool by_keyframe = false);

}  // namespace turnlight::estimator::observe
