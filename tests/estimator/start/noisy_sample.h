// A sample of a scene's own radiances with noise, as the tests of starts need it.
#pragma once

#include "base/angles.h"
#include "estimator/observe/intensity_map.h"
#include "estimator/start/sample.h"
#include "tests/estimator/random_observations.h"

namespace turnlight::estimator::start {

inline constexpr double kSampleNoise = 0.003;

inline observe::Observations NoisyPixels(const model::Scene& truth, std::uint64_t seed,
                                         std::size_t count = 4000) {
  observe::Observations out = RandomObservations(count, 3, seed, &truth).observations;
  AddNoise(kSampleNoise, seed, out);
  out.subsampled = true;
  return out;
}

inline Sample NoisySample(const model::Scene& truth, std::uint64_t seed = 1) {
  return {NoisyPixels(truth, seed), kSampleNoise, {}};
}

inline std::vector<observe::MapPoint> ClustersOf(const Sample& sample) {
  return observe::LeaderClustering(
      observe::HighIntensityArea(observe::MakeIntensityMap(sample.pixels), observe::kHighShare),
      DegToRad(observe::kClusterRadiusDeg));
}

// A light that TwoLights has not: to be found missing, or to be thrown out.
inline model::Light ThirdLight(double intensity = 0.3) {
  return {Eigen::Vector3d(0.1, -0.9, 0.4).normalized(), 0.1, intensity, Eigen::Vector3d::Ones()};
}

}  // namespace turnlight::estimator::start
