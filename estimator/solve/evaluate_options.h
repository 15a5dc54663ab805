// How the model is compared with the observations.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "estimator/observe/observations.h"
#include "estimator/observe/trace_pixels.h"
#include "estimator/solve/shadows.h"

namespace turnlight::estimator::solve {

struct FrameFactors;

struct EvaluateOptions {
  // Sub-samples per side of a pixel's footprint for the highlight, one per tile; empty: 1
  // everywhere.
  std::vector<std::uint8_t> samples_per_side;
  // The part of a pixel's width that those cover.
  double aperture = observe::kAperture;
  // Which lights the observations see; empty: all of them.
  Shadows shadows;
  // Scale of Huber's loss on the root-mean-square residual of a pixel, in radiance; 0: squares.
  double huber = 0.0;
  // What a departure of the diffuse part from its model costs: half of this times its square, in
  // radiance^2.
  double shading_price = 0.0;
  // Cost and gradient are enough: the hessian is left without meaning.
  bool gradient_only = false;
  // Free factors are to follow the other parameters as in an elimination before: for parts of the
  // observations, at the solution of the whole.
  std::shared_ptr<const FrameFactors> factors;
};

// How many values, pixels times channels, a cost is a sum over; of pixels that share what they
// tell, how many independent ones.
double ValueCount(const observe::Observations& observations, const EvaluateOptions& options);

}  // namespace turnlight::estimator::solve
