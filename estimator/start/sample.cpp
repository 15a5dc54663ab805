#include "estimator/start/sample.h"

#include <algorithm>
#include <cmath>

namespace turnlight::estimator::start {
namespace {

constexpr double kExcessFloor = 5e-4;  // radiance: what footprints and edges leave even when clean
constexpr double kNoiseFloor = 0.005;  // of noise^2: how well it is known

double ExcessFloor(double noise) {
  return kExcessFloor * kExcessFloor + kNoiseFloor * noise * noise;
}

}  // namespace

double ValuesIn(const observe::Observations& pixels) {
  return static_cast<double>(pixels.used) * pixels.channels;
}

double ExcessVariance(double mean_square, double noise) {
  return std::max(mean_square - noise * noise, 0.0) + ExcessFloor(noise);
}

bool NothingLeft(double excess, const Sample& sample) {
  const double spread = sample.noise * sample.noise * std::sqrt(2.0 / ValuesIn(sample.pixels));
  return excess <= 1.5 * ExcessFloor(sample.noise) + 4.0 * spread;
}

}  // namespace turnlight::estimator::start
