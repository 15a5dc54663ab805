// Small statistics of studies.
#pragma once

#include <vector>

namespace turnlight::studies {

// How many of `trials` may succeed at the given probability: the central band that holds at least
// `level` of the binomial distribution, tails cut equally.
struct Band {
  int low = 0;
  int high = 0;
};
Band BinomialBand(int trials, double probability, double level);

}  // namespace turnlight::studies
