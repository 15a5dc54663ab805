#include "estimator/find_start.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/angles.h"
#include "estimator/find_lights.h"
#include "estimator/fit_guess.h"
#include "estimator/held_out.h"
#include "estimator/sampling.h"

namespace turnlight::estimator {
namespace {

// Pixels that a start is found on; with noise of more than 2 % of white more, up to eight times.
constexpr double kSampleSize = 6000.0, kSampledNoise = 0.02, kMostSamples = 8.0;

}  // namespace

Start FindStart(const Observations& all, double noise, const IntensityMap& map,
                const std::optional<InitialGuess>& guess, const ModelChoice& choice) {
  const double more = std::clamp(std::pow(noise / kSampledNoise, 2), 1.0, kMostSamples);
  const Sample sample{Subsample(all, static_cast<std::size_t>(kSampleSize * more), 1), noise,
                      choice};
  const auto clusters =
      LeaderClustering(HighIntensityArea(map, kHighShare), DegToRad(kClusterRadiusDeg));
  Start out;
  Candidate candidate;
  if (guess) {
    candidate = FitGuess(sample, *guess, clusters, out.ladder);
  } else {
    candidate = FindLights(sample, clusters, out.ladder);
    candidate = ChooseDiffuse(sample, candidate, out.ladder);
    candidate = ChooseLobe(sample, candidate, out.ladder);
    candidate = CheckHeldOut(Subsample(all, static_cast<std::size_t>(kSampleSize), 2), sample,
                             std::move(candidate), out.ladder);
  }
  out.scene = std::move(candidate.scene);
  out.rms_history = std::move(candidate.rms_history);
  return out;
}

}  // namespace turnlight::estimator
