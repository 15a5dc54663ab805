#include "estimator/report.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "estimator/solve/normal_equations.h"
#include "estimator/uncertainty/correlation.h"
#include "estimator/uncertainty/quantities.h"
#include "estimator/uncertainty/reported.h"
#include "estimator/uncertainty/uncertainty.h"

namespace turnlight::estimator {
namespace {

constexpr double kNinetyFivePercent = 1.6449;  // sigmas, one-sided

LightEstimate MakeLight(const uncertainty::ReportedLight& reported,
                        const uncertainty::LightSigma& sigma, bool near, double rho_free,
                        double rho_sigma, double rho_calibration, bool strongest) {
  LightEstimate out;
  out.light = reported.light;
  out.near = near;
  out.direction_sigma = sigma.direction;
  // A light held at infinity: what the fit with free distances found belongs to the error of 0.
  if (!near) rho_sigma = std::hypot(rho_sigma, rho_calibration);
  out.inverse_distance_sigma = near ? sigma.inverse_distance : std::hypot(rho_sigma, rho_free);
  const double upper = rho_free + kNinetyFivePercent * rho_sigma;
  if (upper > 0.0 && std::isfinite(upper)) out.distance_min = 1.0 / upper;
  if (near) {
    out.distance = 1.0 / reported.light.inverse_distance;
    out.distance_sigma = sigma.distance;
    out.position = reported.light.direction / reported.light.inverse_distance;
    out.position_covariance = sigma.position_covariance;
  }
  out.direction_at_reference = reported.direction_at_reference;
  if (!strongest) out.intensity_sigma = sigma.intensity;
  out.colour_sigma = sigma.colour;
  out.diffuse_product = reported.diffuse_product;
  out.diffuse_product_sigma = sigma.diffuse_product;
  out.specular_product = reported.specular_product;
  out.specular_product_sigma = sigma.specular_product;
  return out;
}

// How many times the statistical sigma of what a light gives its total one is: at least 1. A
// factor's is so many times its own, for what is wrong with a light's share is wrong with both.
double TotalOverStat(const uncertainty::LightSigma& total, const uncertainty::LightSigma& stat) {
  double most = 1.0;
  for (int c = 0; c < 3; ++c)
    if (stat.diffuse_product[c] > 0.0)
      most = std::max(most, total.diffuse_product[c] / stat.diffuse_product[c]);
  return std::isfinite(most) ? most : 1.0;
}

void FillSigmas(const uncertainty::Uncertainty& sigma, double specular_limit, Estimate& out) {
  out.sigma.albedo = sigma.albedo;
  out.sigma.ambient = sigma.ambient;
  out.sigma.diffuse = sigma.diffuse;
  out.sigma.harmonics = sigma.harmonics;
  out.ambient_product_sigma = sigma.ambient_product;
  out.sigma.ambient_colour = sigma.ambient_colour;
  out.sigma.specular_colour = sigma.specular_colour;
  for (std::size_t k = 0; k < model::kMostLobes; ++k) {
    const uncertainty::LobeSigma& lobe = sigma.lobes[k];
    out.sigma.lobes[k].strength = lobe.strength;
    if (!out.reflectance.lobes[k].present()) continue;
    if (std::isfinite(lobe.shape)) out.sigma.lobes[k].shape = lobe.shape;
    if (lobe.f0 > 0.0 && std::isfinite(lobe.f0)) out.sigma.lobes[k].f0 = lobe.f0;
  }
  if (!out.reflectance.lobes[0].present()) {
    out.sigma.lobes[0].strength = specular_limit;
    for (LightEstimate& light : out.lights)
      light.specular_product_sigma[0] = specular_limit * light.light.intensity;
  }
  if (out.reflectance.diffuse_model == model::DiffuseModel::kOrenNayar &&
      std::isfinite(sigma.roughness))
    out.sigma.roughness = sigma.roughness;
  out.condition = sigma.condition;
  out.weak = sigma.weak;
}

// The item of the budget, made if it is not there yet.
uncertainty::Uncertainty& ItemOf(const uncertainty::BudgetWords& words, Estimate& out) {
  for (uncertainty::BudgetItem& item : out.budget)
    if (item.words.item == words.item) return item.sigma;
  uncertainty::BudgetItem item{words, {}};
  item.sigma.lights.resize(out.lights.size());
  out.budget.push_back(item);
  return out.budget.back().sigma;
}

double Rest(double total, double part) {
  return std::sqrt(std::max(total * total - part * part, 0.0));
}

// Of what the fit holds at 0 the sigmas are those of an earlier fit, which did not.
void FillBudgetOfHeld(const select::Refined& refined, const std::vector<std::size_t>& order,
                      Estimate& out) {
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::size_t l = order[i];
    if (refined.near[l]) continue;
    const double stat = refined.inverse_distance_sigma_stat[l];
    ItemOf(uncertainty::NoiseWords(), out).lights[i].inverse_distance = stat;
    ItemOf(uncertainty::EarlierWords(), out).lights[i].inverse_distance =
        Rest(refined.inverse_distance_sigma[l], stat);
    ItemOf(uncertainty::LightsWords(), out).lights[i].inverse_distance =
        std::abs(refined.inverse_distance[l]);
  }
  if (out.reflectance.lobes[0].model != model::SpecularModel::kNone) return;
  const double stat = refined.specular_sigma_stat, rest = Rest(refined.specular_sigma, stat);
  for (const auto& [words, sigma] :
       {std::pair(&uncertainty::NoiseWords(), stat), {&uncertainty::EarlierWords(), rest}}) {
    uncertainty::Uncertainty& item = ItemOf(*words, out);
    item.lobes[0].strength = sigma;
    for (std::size_t i = 0; i < order.size(); ++i)
      item.lights[i].specular_product[0] = sigma * out.lights[i].light.intensity;
  }
}

// The covariance of the sigmas that are reported: of what the fit holds at 0 they are those of an
// earlier fit, which go together with no other error but, of what a highlight would give, each
// other.
uncertainty::Correlation CorrelationOfAll(Eigen::MatrixXd covariance,
                                          const uncertainty::Reported& reported,
                                          const Estimate& estimate) {
  using uncertainty::At;
  using uncertainty::OfLight;
  const bool no_lobe = !estimate.reflectance.lobes[0].present();
  for (std::size_t i = 0; i < estimate.lights.size(); ++i) {
    const LightEstimate& light = estimate.lights[i];
    const Eigen::Index distance = At(OfLight::kInverseDistance, i);
    if (!light.near)
      covariance(distance, distance) = light.inverse_distance_sigma * light.inverse_distance_sigma;
    for (std::size_t j = 0; no_lobe && j < estimate.lights.size(); ++j)
      covariance(At(OfLight::kSpecularProduct, i), At(OfLight::kSpecularProduct, j)) =
          light.specular_product_sigma[0] * estimate.lights[j].specular_product_sigma[0];
  }
  return uncertainty::CorrelationOf(covariance, reported, estimate.channels);
}

// How much of a pixel's information a robust loss leaves, mean over the unknowns.
double LossShare(const observe::Observations& all, const select::Refined& refined,
                 const std::vector<int>& unknowns) {
  if (!(refined.solution.evaluate.huber > 0.0) || unknowns.empty()) return 1.0;
  solve::EvaluateOptions squares = refined.solution.evaluate;
  squares.huber = 0.0;
  const Eigen::VectorXd whole =
      solve::Evaluate(all, refined.solution.scene, squares).hessian.diagonal()(unknowns);
  const Eigen::VectorXd left = refined.solution.equations.hessian.diagonal()(unknowns);
  return (left.array() / whole.array().max(1e-300)).mean();
}

FitState StateOf(const observe::Observations& all, const select::Refined& refined,
                 uncertainty::DirectionForecast directions) {
  FitState out;
  out.scene = refined.solution.scene;
  out.frame = observe::FrameOf(all);
  out.kept_share = all.blocks.share;
  out.photograph = refined.splits.photograph.has_value();
  if (!out.photograph && !out.scene.flickers())
    out.loss_share = LossShare(all, refined, directions.unknowns);
  out.directions = std::move(directions);
  return out;
}

// In white.
double RmsOf(const observe::Observations& all, double values, double cost) {
  return all.radiance_unit * std::sqrt(2.0 * cost / values);
}

}  // namespace

void FillResidual(const observe::Observations& all, const select::Refined& refined, Estimate& out) {
  solve::EvaluateOptions squares = refined.options.evaluate;
  squares.huber = 0.0;
  squares.shading_price = 0.0;
  squares.gradient_only = true;
  out.rms = RmsOf(all, solve::ValueCount(all, squares),
                  solve::Evaluate(all, refined.solution.scene, squares).cost);
}

void FillFromFit(const observe::Observations& all, const select::Refined& refined, Estimate& out,
                 const uncertainty::CalibrationResponse* calibration) {
  const solve::Solution& solution = refined.solution;
  const auto order = uncertainty::StrengthOrder(solution.scene, all);
  const uncertainty::Reported reported = uncertainty::Report(solution.scene, all, order);
  uncertainty::Uncertainties sigmas = uncertainty::EstimateUncertainty(
      solution, all, order, refined.views_per_distinct, refined.splits, calibration);
  const uncertainty::Uncertainty& sigma = sigmas.total;
  out.stat = sigmas.stat;
  out.fit = StateOf(all, refined, std::move(sigmas.forecast));
  out.budget = std::move(sigmas.budget);
  out.count = sigmas.count;
  out.reflectance = reported.reflectance;
  out.reference_point = all.reference;
  out.channels = all.channels;
  out.ambient_product = reported.ambient_product;
  for (std::size_t i = 0; i < order.size(); ++i)
    out.lights.push_back(
        MakeLight(reported.lights[i], sigma.lights[i], refined.near[order[i]],
                  refined.inverse_distance[order[i]], refined.inverse_distance_sigma[order[i]],
                  calibration ? sigmas.calibration.lights[i].inverse_distance : 0.0, i == 0));
  for (std::size_t i = 0; i < sigmas.factors.size(); ++i) {
    out.lights[i].factor_sigma = sigmas.factors[i];
    const double share = TotalOverStat(sigmas.total.lights[i], sigmas.stat.lights[i]);
    for (double& factor : out.lights[i].factor_sigma) factor *= share;
  }
  FillSigmas(sigma, refined.specular_sigma, out);
  out.correlation = CorrelationOfAll(std::move(sigmas.covariance), reported, out);
  for (std::size_t i = 0; i < order.size(); ++i)
    if (!refined.near[order[i]])
      out.stat.lights[i].inverse_distance = refined.inverse_distance_sigma_stat[order[i]];
  if (out.reflectance.lobes[0].model == model::SpecularModel::kNone) {
    out.stat.lobes[0].strength = refined.specular_sigma_stat;
    for (std::size_t i = 0; i < order.size(); ++i)
      out.stat.lights[i].specular_product[0] =
          refined.specular_sigma_stat * out.lights[i].light.intensity;
  }
  FillBudgetOfHeld(refined, order, out);
  FillResidual(all, refined, out);
  const double values = solve::ValueCount(all, refined.options.evaluate);
  out.pixels = all.used - refined.options.evaluate.shadows.left_out;
  out.iterations = refined.iterations;
  out.stopped = solution.stopped;
  for (const double cost : refined.cost_history)
    out.history.push_back({static_cast<int>(out.history.size()), RmsOf(all, values, cost)});
}

}  // namespace turnlight::estimator
