#include "estimator/start/find_start.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/angles.h"
#include "estimator/observe/sampling.h"
#include "estimator/start/add_missing_lights.h"
#include "estimator/start/find_lights.h"
#include "estimator/start/fit_guess.h"
#include "estimator/start/held_out.h"
#include "estimator/start/second_lobe.h"

namespace turnlight::estimator::start {
namespace {

// Pixels that a start is found on; with noise of more than 2 % of white more, up to eight times.
constexpr double kSampleSize = 6000.0, kSampledNoise = 0.02, kMostSamples = 8.0;
constexpr int kMostImprovements = 3;

// Whether two are of the same model: as many lights on the same kind of surface.
bool AreAlike(const model::Scene& a, const model::Scene& b) {
  const auto same_lobe = [&](std::size_t k) {
    return a.reflectance.lobes[k].model == b.reflectance.lobes[k].model;
  };
  return a.lights.size() == b.lights.size() && same_lobe(0) && same_lobe(1) &&
         a.reflectance.diffuse_model == b.reflectance.diffuse_model;
}

// The diffuse model, the lobes and, once the surface is another one, the lights again, until
// nothing changes. Rungs are those of the last round that changed something.
Candidate Improve(const Sample& sample, Candidate candidate, std::vector<model::Rung>& ladder) {
  std::vector<model::Rung> told;
  for (int round = 0; round < kMostImprovements && !StopRequested(sample.stop); ++round) {
    std::vector<model::Rung> rungs;
    const model::Scene before = candidate.scene;
    candidate = ChooseDiffuse(sample, candidate, rungs);
    candidate = ChooseLobeAndCoat(sample, candidate, rungs);
    candidate = ChooseSecondLobe(sample, candidate, rungs);
    const bool same = AreAlike(candidate.scene, before);
    if (round == 0 || !same) told = std::move(rungs);
    if (same || NothingLeft(candidate.excess, sample)) break;
    const std::size_t lights = candidate.scene.lights.size();
    candidate = AddMissingLights(sample, std::move(candidate));
    if (candidate.scene.lights.size() == lights) break;
  }
  ladder.insert(ladder.end(), told.begin(), told.end());
  return candidate;
}

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
    candidate = Improve(sample, std::move(candidate), out.ladder);
    candidate =
        CheckHeldOut(observe::Subsample(all, static_cast<std::size_t>(kSampleSize), 2, by_keyframe),
                     sample, std::move(candidate), out.ladder);
  }
  out.least_kept = candidate.least_kept;
  out.scene = std::move(candidate.scene);
  out.rms_history = std::move(candidate.rms_history);
  return out;
}

}  // namespace turnlight::estimator::start
