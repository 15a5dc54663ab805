#include "estimator/select/intensity_rung.h"

#include <algorithm>
#include <cmath>

#include "base/format.h"
#include "estimator/solve/frame_factors.h"
#include "estimator/solve/unit_diagonal.h"

namespace turnlight::estimator::select {
namespace {

constexpr double kLeastChange = 0.003;                  // root mean square of the factors about 1
constexpr double kScreenedChange = kLeastChange / 3.0;  // from where it is worth a solve
constexpr double kVarianceRatio = 1.25;
constexpr double kAsGood = 0.9;  // of the variance that factors explain
constexpr char kIntensities[] = "changing-intensities";

// How much a light's factors vary, and the sigma of one of them.
struct Variation {
  double rms = 0.0, sigma = 0.0;
};

// The columns that are not held.
std::vector<int> Unknowns(const solve::Solution& solution) {
  std::vector<int> unknowns;
  for (std::size_t column = 0; column < solution.held.size(); ++column)
    if (!solution.held[column]) unknowns.push_back(static_cast<int>(column));
  return unknowns;
}

// Of the light that varies most, counted in sigmas; those have what the other parameters leave
// open in them, too.
Variation MostVaried(const solve::Solution& solution, double variance) {
  Variation most;
  double most_sigmas = -1.0;
  const std::vector<int> unknowns = Unknowns(solution);
  const solve::ScaledFactor information(solution.equations.hessian(unknowns, unknowns));
  if (!information.Good()) return most;
  const solve::FrameFactors& factors = *solution.equations.factors;
  for (std::size_t l = 0; l < solution.scene.lights.size(); ++l) {
    const auto at = static_cast<Eigen::Index>(l);
    double square = 0.0, own = 0.0;
    int seen = 0;
    for (std::size_t k = 0; k < factors.keyframes.size(); ++k) {
      const solve::FrameFactors::Keyframe& keyframe = factors.keyframes[k];
      if (!keyframe.seen[l]) continue;
      const Eigen::VectorXd by = keyframe.by_others.row(at).transpose()(unknowns);
      square += std::pow(solution.scene.lights[l].factors[k] - 1.0, 2);
      own += variance * (keyframe.covariance(at, at) + by.dot(information.Solve(by)));
      ++seen;
    }
    if (seen < 2) continue;
    const Variation varied{std::sqrt(square / seen), std::sqrt(own / seen)};
    const double sigmas = varied.rms / std::max(varied.sigma, 1e-12);
    if (!(sigmas > most_sigmas)) continue;
    most_sigmas = sigmas;
    most = varied;
  }
  return most;
}

double VarianceOf(const observe::Observations& observations, const solve::Solution& solution) {
  const double rms = Rms(observations, solution);
  return rms * rms;
}

// What factors would explain, counted in a value's variance, and how far they would go from 1 with
// all else as it is.
struct Screen {
  double explained = 0.0, parameters = 0.0, change = 0.0;
  bool passed() const {
    return explained > parameters + kChance * std::sqrt(2.0 * parameters) &&
           change > kScreenedChange;
  }
};

// Root mean square of the steps, of the light that moves most.
double LargestChange(const solve::FrameFactors& factors, std::size_t lights) {
  double most = 0.0;
  for (std::size_t l = 0; l < lights; ++l) {
    double square = 0.0, seen = 0.0;
    for (const solve::FrameFactors::Keyframe& keyframe : factors.keyframes) {
      if (!keyframe.seen[l]) continue;
      square += std::pow(keyframe.step[static_cast<Eigen::Index>(l)], 2);
      seen += 1.0;
    }
    most = std::max(most, std::sqrt(square / std::max(seen, 1.0)));
  }
  return most;
}

model::Scene WithFreeFactors(const observe::Observations& observations, model::Scene scene) {
  scene.free_factors = true;
  solve::CompleteFactors(observations.tile_begin.size() - 1, scene);
  return scene;
}

Screen ScreenOf(const observe::Observations& observations, const solve::Solution& solution) {
  const solve::NormalEquations there = solve::Evaluate(
      observations, WithFreeFactors(observations, solution.scene), solution.evaluate);
  const double variance = std::max(VarianceOf(observations, solution), 1e-300);
  return {2.0 * there.factors->gain / variance, static_cast<double>(there.factors->count()),
          LargestChange(*there.factors, solution.scene.lights.size())};
}

// What became of a look at factors: the fit with them, or uneven ambient light in their place.
struct Tried {
  Refined changing;
  bool uneven = false;
};

// Uneven ambient light looks different from keyframe to keyframe, too, and is simpler: taken if it
// explains nearly all that factors do.
Tried TryBoth(const observe::Observations& observations, bool uneven_allowed, Refined& out) {
  Tried tried{out, false};
  tried.changing.solution.scene = WithFreeFactors(observations, out.solution.scene);
  SolveOn(observations, tried.changing);
  if (!uneven_allowed) return tried;
  Refined uneven = out;
  uneven.solution.scene.free_harmonics = true;
  SolveOn(observations, uneven);
  const double before = VarianceOf(observations, out.solution),
               by_uneven = before - VarianceOf(observations, uneven.solution),
               by_factors = before - VarianceOf(observations, tried.changing.solution);
  tried.uneven = by_uneven > 0.0 && by_uneven > kAsGood * by_factors;
  if (tried.uneven) out = std::move(uneven);
  return tried;
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
  if (scene.free_factors) {
    ladder.push_back({kIntensities, true, "as in the estimate before"});
    return;
  }
  if (observations.tile_begin.size() < 3 || scene.lights.empty()) return;
  Screen screen = ScreenOf(observations, out.solution);
  Tried tried;
  if (screen.passed()) {
    tried = TryBoth(observations, !scene.free_harmonics && !choice.harmonics, out);
    if (tried.uneven) screen = ScreenOf(observations, out.solution);
    if (tried.uneven && screen.passed()) tried = TryBoth(observations, false, out);
    if (StopRequested(out.options.stop)) return;
  }
  const double values = solve::ValueCount(observations, out.solution.evaluate);
  if (!screen.passed()) {
    ladder.push_back({kIntensities, false,
                      Format("a factor for each light in each keyframe would explain %.3g of the "
                             "residuals' variance, chance alone %.3g, and be %.2g off 1; it is "
                             "tried from %.2g on",
                             screen.explained / values, screen.parameters / values, screen.change,
                             kScreenedChange)});
    return;
  }
  Refined& changing = tried.changing;
  const double variance = VarianceOf(observations, out.solution),
               left = VarianceOf(observations, changing.solution);
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
