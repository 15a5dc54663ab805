#include "estimator/select/intensity_rung.h"

#include <algorithm>
#include <cmath>

#include "base/format.h"
#include "estimator/solve/frame_factors.h"

namespace turnlight::estimator::select {
namespace {

constexpr double kLeastChange = 0.003;  // root mean square of the factors about 1
constexpr double kVarianceRatio = 1.25;
constexpr char kIntensities[] = "changing-intensities";

// How much a light's factors vary, and the sigma of one of them.
struct Variation {
  double rms = 0.0, sigma = 0.0;
};

// Of the light that varies most, counted in sigmas.
Variation MostVaried(const solve::Solution& solution, double variance) {
  Variation most;
  double most_sigmas = -1.0;
  const solve::FrameFactors& factors = *solution.equations.factors;
  for (std::size_t l = 0; l < solution.scene.lights.size(); ++l) {
    double square = 0.0, own = 0.0;
    int seen = 0;
    for (std::size_t k = 0; k < factors.keyframes.size(); ++k) {
      if (!factors.keyframes[k].seen[l]) continue;
      const auto at = static_cast<Eigen::Index>(l);
      square += std::pow(solution.scene.lights[l].factors[k] - 1.0, 2);
      own += variance * factors.keyframes[k].covariance(at, at);
      ++seen;
    }
    if (seen < 2) continue;
    const Variation varied{std::sqrt(square / seen), std::sqrt(own / seen)};
    const double sigmas = varied.rms / std::max(varied.sigma, 1e-12);
    if (varied.rms < kLeastChange || !(sigmas > most_sigmas)) continue;
    most_sigmas = sigmas;
    most = varied;
  }
  return most;
}

}  // namespace

bool IsOfIntensities(const model::Rung& rung) { return rung.rung == kIntensities; }

void ChooseIntensities(const observe::Observations& observations, double noise,
                       const model::ModelChoice& choice, Refined& out,
                       std::vector<model::Rung>& ladder) {
  model::Scene& scene = out.solution.scene;
  if (choice.changing) {
    if (std::none_of(ladder.begin(), ladder.end(), IsOfIntensities))
      ladder.push_back({kIntensities, *choice.changing, "as asked for"});
    return;
  }
  if (scene.free_factors || observations.tile_begin.size() < 3 || scene.lights.empty()) return;
  const double values = solve::ValueCount(observations, out.solution.evaluate);
  const double variance = 2.0 * out.solution.equations.cost / values;
  model::Scene tried = scene;
  tried.free_factors = true;
  solve::CompleteFactors(observations.tile_begin.size() - 1, tried);
  const solve::NormalEquations there = solve::Evaluate(observations, tried, out.solution.evaluate);
  const double parameters = there.factors->count();
  const double explained = 2.0 * there.factors->gain / std::max(variance, 1e-300);
  if (!(explained > parameters + kChance * std::sqrt(2.0 * parameters))) {
    ladder.push_back({kIntensities, false,
                      Format("a factor for each light in each keyframe would explain %.3g of the "
                             "residuals' variance; chance alone explains %.3g",
                             explained / values, parameters / values)});
    return;
  }
  Refined changing = out;
  changing.solution.scene = tried;
  SolveOn(observations, changing);
  const double left = 2.0 * changing.solution.equations.cost / values;
  const Variation varied = MostVaried(changing.solution, left);
  const bool noise_only = std::sqrt(left) <= kBeyondNoise * noise;
  const bool accepted = varied.rms >= kLeastChange && varied.rms > kSignificance * varied.sigma &&
                        (noise_only || kVarianceRatio * left < variance);
  ladder.push_back(
      {kIntensities, accepted,
       Format("with a factor for each light in each keyframe the residual rms is %.3g, without "
              "%.3g, noise %.3g; the factors vary by %.2g %%, each with sigma %.2g %%; they count "
              "from %.2g %% and 3 sigma where only noise is left, else if the variance is also "
              "%.2f times smaller",
              std::sqrt(left), std::sqrt(variance), noise, 100.0 * varied.rms, 100.0 * varied.sigma,
              100.0 * kLeastChange, kVarianceRatio)});
  if (accepted) out = std::move(changing);
}

}  // namespace turnlight::estimator::select
