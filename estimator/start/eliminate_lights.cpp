#include "estimator/start/eliminate_lights.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "estimator/start/score.h"

namespace turnlight::estimator::start {
namespace {

constexpr double kHardlyMissed = 1.2;  // of the excess variance: no need to try others

// The best fit without one of the weakest four lights; the first that is hardly missed will do.
Candidate BestWithoutOne(const Sample& sample, const Candidate& full, double noise) {
  std::optional<Candidate> best;
  for (const std::size_t index : WeakestLights(full.scene, 4)) {
    Candidate start = full;
    start.scene.lights.erase(start.scene.lights.begin() + static_cast<std::ptrdiff_t>(index));
    Candidate candidate = Refit(sample, start, 20, noise, kToCompare);
    if (!best || candidate.excess < best->excess) best = std::move(candidate);
    if (best->excess <= kHardlyMissed * full.excess) break;
  }
  return std::move(*best);
}

}  // namespace

std::vector<std::size_t> WeakestLights(const model::Scene& scene, std::size_t most) {
  std::vector<std::size_t> order(scene.lights.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return model::Strength(scene.lights[a]) < model::Strength(scene.lights[b]);
  });
  order.resize(std::min(order.size(), most));
  return order;
}

Candidate Eliminate(const Sample& sample, const Candidate& fitted) {
  Candidate best = Refit(sample, fitted, 40, sample.noise, kToKeep);
  // With lights to spare what is left is noise; a larger estimate of it would hide lights.
  const double least = std::min(sample.noise, std::sqrt(best.mean_square));
  best.excess = ExcessVariance(best.mean_square, least);
  const auto wanted = static_cast<std::size_t>(sample.choice.lights.value_or(0));
  while (best.scene.lights.size() > wanted) {
    Candidate fewer = BestWithoutOne(sample, best, least);
    if (!sample.choice.lights && fewer.excess >= RatioFor(kLightPrice) * best.excess) {
      best.least_kept = fewer.excess / best.excess;
      break;
    }
    best = std::move(fewer);
  }
  return Refit(sample, best, 40, sample.noise, kToKeep);
}

}  // namespace turnlight::estimator::start
