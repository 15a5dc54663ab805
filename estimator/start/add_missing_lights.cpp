#include "estimator/start/add_missing_lights.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/angles.h"
#include "estimator/solve/matched_filter.h"
#include "estimator/start/eliminate_lights.h"
#include "estimator/start/merge_lights.h"
#include "estimator/start/score.h"

namespace turnlight::estimator::start {
namespace {

constexpr double kPeakSeparationDeg = 20.0;
constexpr std::size_t kMostPeaks = 8;
constexpr double kLeastGain = 0.05;  // of the best direction's
constexpr int kMostRounds = 5;
constexpr double kLeastFallPerRound = 1.2;  // of the excess variance
constexpr std::size_t kMostLights = 40;     // more would cost more than they could tell

// The best directions that are well apart.
std::vector<model::Light> Peaks(const std::vector<solve::MissingLight>& gains, std::size_t room) {
  const double cosine = std::cos(DegToRad(kPeakSeparationDeg));
  std::vector<model::Light> peaks;
  for (const solve::MissingLight& gain : gains) {
    if (peaks.size() == std::min(room, kMostPeaks) || gain.gain < kLeastGain * gains.front().gain)
      break;
    const auto close = [&](const model::Light& p) {
      return p.direction.dot(gain.light.direction) > cosine;
    };
    if (std::none_of(peaks.begin(), peaks.end(), close)) peaks.push_back(gain.light);
  }
  // Each intensity is what would do alone.
  for (model::Light& light : peaks) light.intensity /= static_cast<double>(peaks.size());
  return peaks;
}

}  // namespace

Candidate AddMissingLights(const Sample& sample, Candidate candidate) {
  const auto wanted = sample.choice.lights;
  Candidate grown = candidate;
  for (int round = 0; round < kMostRounds; ++round) {
    const std::size_t lights = grown.scene.lights.size();
    const bool enough =
        wanted ? lights >= static_cast<std::size_t>(*wanted) : NothingLeft(grown.excess, sample);
    if (enough || lights >= kMostLights) break;
    model::Scene start = grown.scene;
    const std::vector<model::Light> peaks = Peaks(
        solve::RankMissingLights(sample.pixels, grown.scene, grown.shadows), kMostLights - lights);
    if (peaks.empty()) break;
    start.lights.insert(start.lights.end(), peaks.begin(), peaks.end());
    Candidate more = FitAndMerge(sample, start);
    if (!wanted && more.excess * kLeastFallPerRound > grown.excess) break;
    more.rms_history.insert(more.rms_history.begin(), grown.rms_history.begin(),
                            grown.rms_history.end());
    grown = std::move(more);
  }
  if (grown.scene.lights.size() == candidate.scene.lights.size()) return candidate;
  // At least one must pay.
  if (!wanted && grown.excess * RatioFor(kLightPrice) > candidate.excess) return candidate;
  // Only from a fit that explains the pictures can it be told which lights are needed.
  grown = Eliminate(sample, grown);
  return wanted || BestOf(sample.choice,
                          {{&candidate.scene, candidate.excess}, {&grown.scene, grown.excess}}) == 1
             ? grown
             : candidate;
}

}  // namespace turnlight::estimator::start
