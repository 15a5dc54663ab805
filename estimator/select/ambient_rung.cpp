#include "estimator/select/ambient_rung.h"

#include <algorithm>
#include <cmath>

#include "base/format.h"
#include "estimator/solve/unit_diagonal.h"
#include "estimator/uncertainty/reported.h"
#include "estimator/uncertainty/uncertainty.h"

namespace turnlight::estimator::select {
namespace {

constexpr double kLeastRms = 0.002;  // of white, over the sphere of normals
constexpr double kLeastShare = 0.2;  // of the residuals' variance, where that is not noise
constexpr char kUneven[] = "ambient-harmonics";

// What the harmonics would lower the cost by, the other unknowns following, and what they would
// be (root mean square, of white): a score test.
struct Gain {
  double cost = 0.0, rms = 0.0;
};

Gain GainOf(const observe::Observations& observations, const solve::Solution& solution) {
  model::Scene scene = solution.scene;
  scene.free_harmonics = true;
  const solve::NormalEquations there = solve::Evaluate(observations, scene, solution.evaluate);
  const model::Parameters with(scene, observations.channels);
  std::vector<int> unknowns;
  for (int column = 0, own = 0; column < with.count(); ++column) {
    const bool harmonic = with[column].kind == model::ParameterKind::kHarmonic;
    if (harmonic || !solution.held[static_cast<std::size_t>(own)]) unknowns.push_back(column);
    if (!harmonic) ++own;
  }
  // At the minimum the gradient by the others is 0, but for rounding.
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(unknowns.size()));
  for (std::size_t i = 0; i < unknowns.size(); ++i)
    if (with[unknowns[i]].kind == model::ParameterKind::kHarmonic)
      gradient[static_cast<Eigen::Index>(i)] = there.gradient[unknowns[i]];
  const solve::ScaledFactor factor(there.hessian(unknowns, unknowns));
  if (!factor.Good()) return {};
  const Eigen::VectorXd step = factor.Solve(gradient);
  double square = 0.0;
  for (std::size_t i = 0; i < unknowns.size(); ++i)
    if (with[unknowns[i]].kind == model::ParameterKind::kHarmonic)
      square += std::pow(step[static_cast<Eigen::Index>(i)], 2);
  // In the observations' unit, as every threshold: the exposure decides nothing.
  return {0.5 * gradient.dot(step),
          solution.scene.reflectance.albedo.maxCoeff() * std::sqrt(square)};
}

// Whether the residuals call for harmonics, by a score test; a rung if not.
bool CallFor(const observe::Observations& observations, const solve::Solution& solution,
             std::vector<model::Rung>& ladder) {
  const double values = solve::ValueCount(observations, solution.evaluate);
  const double variance = 2.0 * solution.equations.cost / values;
  const Gain gain = GainOf(observations, solution);
  const double explained = 2.0 * gain.cost / std::max(variance, 1e-300);
  if (!(explained > model::kHarmonics + kChance * std::sqrt(2.0 * model::kHarmonics)) ||
      !(gain.rms > 0.5 * kLeastRms)) {
    ladder.push_back(
        {kUneven, false,
         Format("ambient light that depends on the normal would explain %.3g of the "
                "residuals' variance, chance alone %.3g, and vary by %.2g of white; it "
                "is tried from %.2g on",
                explained / values, model::kHarmonics / values, gain.rms, 0.5 * kLeastRms)});
    return false;
  }
  // Where more than noise is left, harmonics can stand for a surface that the model lacks.
  const bool beyond_noise = solution.evaluate.huber > 0.0;
  if (beyond_noise && explained < kLeastShare * values) {
    ladder.push_back({kUneven, false,
                      Format("ambient light that depends on the normal would explain %.3g of the "
                             "residuals' variance; as more than noise is left, it counts from %.2g",
                             explained / values, kLeastShare)});
    return false;
  }
  return true;
}

bool IsOneView(const observe::Observations& observations) {
  return observations.tile_begin.size() == 2;
}

// Of the harmonic that is clearest from 0.
double MostSigmas(const model::Reflectance& found, const uncertainty::Uncertainty& sigma) {
  double most = 0.0;
  for (int j = 0; j < model::kHarmonics; ++j)
    if (std::isfinite(sigma.harmonics[j]) && sigma.harmonics[j] > 0.0)
      most = std::max(most, std::abs(found.harmonics[j]) / sigma.harmonics[j]);
  return most;
}

}  // namespace

bool IsOfHarmonics(const model::Rung& rung) { return rung.rung == kUneven; }

void ChooseHarmonics(const observe::Observations& observations, double noise,
                     const model::ModelChoice& choice, Refined& out,
                     std::vector<model::Rung>& ladder) {
  if (choice.harmonics) {
    ladder.push_back({kUneven, *choice.harmonics, "as asked for"});
    return;
  }
  const bool fitted = out.solution.scene.free_harmonics;
  if (!fitted && !CallFor(observations, out.solution, ladder)) return;
  Refined uneven = out;
  uneven.solution.scene.free_harmonics = true;
  if (!fitted) SolveOn(observations, uneven);
  if (StopRequested(out.options.stop)) return;
  if (!fitted && IsOneView(observations) &&
      Rms(observations, uneven.solution) > kBeyondNoise * noise) {
    ladder.push_back({kUneven, false,
                      Format("with ambient light that depends on the normal the residual rms is "
                             "%.3g, more than noise: in a single view that can as well be what "
                             "the surface's model lacks",
                             Rms(observations, uneven.solution))});
    return;
  }
  uneven.splits = uncertainty::SplitResiduals(observations, uneven.solution);
  const auto order = uncertainty::StrengthOrder(uneven.solution.scene, observations);
  const uncertainty::Uncertainty sigma =
      uncertainty::EstimateUncertainty(uneven.solution, observations, order,
                                       uneven.views_per_distinct, uneven.splits)
          .total;
  const uncertainty::Reported reported =
      uncertainty::Report(uneven.solution.scene, observations, order);
  const double most = MostSigmas(reported.reflectance, sigma);
  const double rms = reported.reflectance.harmonics.norm() / observations.radiance_unit;
  const bool accepted = most > kSignificance && rms >= kLeastRms;
  ladder.push_back(
      {kUneven, accepted,
       Format("the ambient light varies with the normal by %.3g of white, the clearest "
              "harmonic is %.1f sigma from 0; it counts from %.2g and %.0f sigma",
              rms, most, kLeastRms, kSignificance)});
  if (accepted) out = std::move(uneven);
  if (accepted || !fitted) return;
  out.solution.scene.free_harmonics = false;
  out.solution.scene.reflectance.harmonics.setZero();
  SolveOn(observations, out);
  if (StopRequested(out.options.stop)) return;
  out.splits = uncertainty::SplitResiduals(observations, out.solution);
}

}  // namespace turnlight::estimator::select
