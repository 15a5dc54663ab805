#include "estimator/start/find_start.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/angles.h"
#include "estimator/observe/sampling.h"
#include "estimator/start/find_lights.h"
#include "estimator/start/fit_guess.h"
#include "estimator/start/held_out.h"
#include "estimator/start/second_lobe.h"

namespace turnlight::estimator::start {
namespace {

// Pixels that a start is found on; with noise of more than 2 % of white more, up to eight times.
constexpr double kSampleSize = 6000.0, kSampledNoise = 0.02, kMostSamples = 8.0;

}  // namespace

Start FindStart(const observe::Observations& all, double noise, const observe::IntensityMap& map,
                const std::optional<model::InitialGuess>& guess, const model::ModelChoice& choice,
                const StopFlag* stop, const Beyond& beyond) {
  const double more = std::clamp(std::pow(noise / kSampledNoise, 2), 1.0, kMostSamples);
  const bool by_keyframe = choice.changing.value_or(false);
  const Sample sample{
      observe::Subsample(all, static_cast<std::size_t>(kSampleSize * more), 1, by_keyframe), noise,
      choice, stop};
  const auto clusters = observe::LeaderClustering(
      observe::HighIntensityArea(map, observe::kHighShare), DegToRad(observe::kClusterRadiusDeg));
  Start out;
  Candidate candidate;
  if (guess) {
    candidate = FitGuess(sample, *guess, clusters, out.ladder);
    if (choice.lobes == 2) candidate = ChooseSecondLobe(sample, candidate, out.ladder);
  } else {
    bool ended = false;
    candidate = FindLights(
        sample, clusters, out.ladder,
        beyond ? Beyond([&](const Sample& asked) { return ended = beyond(asked); }) : Beyond());
    if (ended) return out;
    candidate = ChooseDiffuse(sample, candidate, out.ladder);
    candidate = ChooseLobeAndCoat(sample, candidate, out.ladder);
    candidate = ChooseSecondLobe(sample, candidate, out.ladder);
    candidate =
        CheckHeldOut(observe::Subsample(all, static_cast<std::size_t>(kSampleSize), 2, by_keyframe),
                     sample, std::move(candidate), out.ladder);
  }
  out.scene = std::move(candidate.scene);
  out.rms_history = std::move(candidate.rms_history);
  return out;
}

}  // namespace turnlight::estimator::start
