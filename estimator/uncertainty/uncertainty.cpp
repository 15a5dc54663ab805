#include "estimator/uncertainty/uncertainty.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "estimator/solve/coordinates.h"
#include "estimator/solve/evaluate_options.h"
#include "estimator/solve/frame_factors.h"
#include "estimator/uncertainty/quantities.h"
#include "estimator/uncertainty/uncertainty_parts.h"

namespace turnlight::estimator::uncertainty {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// Of a lobe without strength, which is nowhere in the pictures: its shape and F0 change nothing.
bool IsNowhere(const model::Parameter& parameter, const model::Scene& scene) {
  const bool of_lobe =
      parameter.kind == model::ParameterKind::kShape || parameter.kind == model::ParameterKind::kF0;
  const auto owner = static_cast<std::size_t>(parameter.owner);
  return of_lobe && !(scene.reflectance.lobes[owner].strength > 0.0);
}

// The columns that count as unknowns: all that are not held. What ended at a bound could be on this
// side of it.
std::vector<int> Unknowns(const solve::Solution& solution, const model::Parameters& parameters) {
  std::vector<int> unknowns;
  for (int column = 0; column < parameters.count(); ++column)
    if (!solution.held[static_cast<std::size_t>(column)] &&
        !IsNowhere(parameters[column], solution.scene))
      unknowns.push_back(column);
  return unknowns;
}

std::string NameOf(const Eigen::VectorXd& direction, const std::vector<int>& unknowns,
                   const model::Parameters& parameters, const model::Scene& scene) {
  std::string text;
  for (Eigen::Index i = 0; i < direction.size(); ++i)
    if (std::abs(direction[i]) > 0.3) {
      const std::string name =
          model::NameOf(parameters[unknowns[static_cast<std::size_t>(i)]], scene);
      if (text.find(name) == std::string::npos) text += (text.empty() ? "" : " against ") + name;
    }
  return text;
}

// What is known of a parameter beside the pictures, as one over a variance: of a distance within
// bounds that of a uniform distribution.
double KnownBeside(const model::Parameter& parameter, const model::Scene& scene) {
  if (parameter.kind != model::ParameterKind::kInverseDistance || !scene.distance.known())
    return 0.0;
  const model::ParameterLimits limits = model::LimitsOf(parameter, scene);
  return 12.0 / std::pow(limits.high - limits.low, 2);
}

// J^T W J, and what is known beside, in units of one over the variance of a value.
Eigen::MatrixXd InformationOver(const std::vector<int>& unknowns, const solve::Solution& solution,
                                const model::Parameters& parameters, double variance) {
  Eigen::MatrixXd out = solution.equations.hessian(unknowns, unknowns);
  for (std::size_t i = 0; i < unknowns.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    out(at, at) += variance * KnownBeside(parameters[unknowns[i]], solution.scene);
  }
  return out;
}

Covariance Invert(const solve::Solution& solution, const observe::Observations& observations,
                  const model::Parameters& parameters, double views_per_distinct) {
  const std::vector<int> unknowns = Unknowns(solution, parameters);
  const double values = solve::ValueCount(observations, solution.evaluate);
  const double factors = solution.equations.factors ? solution.equations.factors->count() : 0.0;
  const double variance = views_per_distinct * 2.0 * solution.equations.cost /
                          std::max(values - static_cast<double>(unknowns.size()) - factors, 1.0);
  Covariance out =
      InvertInformation(InformationOver(unknowns, solution, parameters, variance), variance);
  for (const Eigen::VectorXd& direction : out.weak_directions)
    out.weak.push_back(NameOf(direction, unknowns, parameters, solution.scene));
  out.unknowns = unknowns;
  return out;
}

// The variance along the larger axis of the total's.
double AlongLargerAxis(const Eigen::Matrix2d& total, const Eigen::Matrix2d& m) {
  const Eigen::Vector2d axis =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(total).eigenvectors().col(1);
  return std::max(axis.dot(m * axis), 0.0);
}

Propagation Propagate(const solve::Solution& solution, const observe::Observations& observations,
                      const std::vector<std::size_t>& order, const model::Parameters& parameters,
                      const Covariance& covariance,
                      const std::optional<model::Scene>& tilted_scene) {
  const Reported at = Report(solution.scene, observations, order);
  const Eigen::VectorXd values = Flatten(at, at);
  const auto n = static_cast<Eigen::Index>(covariance.unknowns.size());
  Propagation out{values,
                  Eigen::MatrixXd::Zero(values.size(), n),
                  std::vector<bool>(static_cast<std::size_t>(values.size()), false),
                  observations.radius,
                  {}};
  if (tilted_scene)
    out.tilt_shift = Flatten(Report(*tilted_scene, observations, order), at) - values;
  for (Eigen::Index i = 0; i < n; ++i) {
    const int column = covariance.unknowns[static_cast<std::size_t>(i)];
    const bool undetermined = covariance.undetermined[static_cast<std::size_t>(i)];
    const double sigma = std::sqrt(covariance.matrix(i, i));
    const double step = undetermined || !(sigma > 0.0) ? 1e-6 : std::min(1e-3 * sigma, 1e-4);
    const auto moved = [&](double by) {
      const Eigen::VectorXd by_column = by * Eigen::VectorXd::Unit(parameters.count(), column);
      return Flatten(
          Report(model::Moved(solution.scene, parameters, by_column), observations, order), at);
    };
    out.jacobian.col(i) = (moved(step) - moved(-step)) / (2.0 * step);
    if (undetermined)
      for (Eigen::Index q = 0; q < values.size(); ++q)
        if (std::abs(out.jacobian(q, i)) > 1e-6 * std::abs(values[q]))
          out.undetermined[static_cast<std::size_t>(q)] = true;
  }
  return out;
}

// total: given for an item of it.
Uncertainty Unflatten(const Eigen::MatrixXd& result, const std::vector<bool>& unknown,
                      std::size_t lights, const Eigen::MatrixXd* total = nullptr) {
  Uncertainty out;
  TakeSigmas(result, unknown, lights, out);
  for (std::size_t l = 0; l < lights; ++l) {
    const Eigen::Index at = At(OfLight::kDirection, l);
    const auto direction = [at](const Eigen::MatrixXd& of) {
      return Eigen::Matrix2d(of.block<2, 2>(at, at));
    };
    const bool is_unknown =
        unknown[static_cast<std::size_t>(at)] || unknown[static_cast<std::size_t>(at) + 1];
    out.lights[l].direction = is_unknown ? kUnknown
                              : total
                                  ? std::sqrt(AlongLargerAxis(direction(*total), direction(result)))
                                  : LongerHalfAxis(direction(result));
    const Eigen::Index position = At(OfLight::kPosition, l);
    out.lights[l].position_covariance = result.block<3, 3>(position, position);
  }
  return out;
}

// Of each light's factors: their own, and what they have of the other parameters'.
std::vector<std::vector<double>> FactorSigmas(const solve::Solution& solution,
                                              const std::vector<std::size_t>& order,
                                              const Covariance& covariance) {
  std::vector<std::vector<double>> out;
  if (!solution.equations.factors) return out;
  for (const std::size_t light : order) {
    std::vector<double>& sigmas = out.emplace_back();
    const auto row = static_cast<Eigen::Index>(light);
    for (const auto& keyframe : solution.equations.factors->keyframes) {
      const Eigen::VectorXd by = keyframe.by_others.row(row).transpose()(covariance.unknowns);
      const double variance =
          covariance.variance * keyframe.covariance(row, row) + by.dot(covariance.matrix * by);
      sigmas.push_back(keyframe.seen[light] ? std::sqrt(std::max(variance, 0.0)) : kUnknown);
    }
  }
  return out;
}

// stat, model: covariances of the reported quantities, the calibration's share in the latter.
DirectionForecast ForecastOf(const solve::Solution& solution, const model::Parameters& parameters,
                             const Covariance& covariance, const Propagation& reported,
                             const Eigen::MatrixXd& stat, const Eigen::MatrixXd& model,
                             std::size_t lights) {
  DirectionForecast out;
  out.unknowns = covariance.unknowns;
  out.variance = covariance.variance;
  out.hessian = InformationOver(out.unknowns, solution, parameters, out.variance);
  for (std::size_t l = 0; l < lights; ++l) {
    const Eigen::Index at = At(OfLight::kDirection, l);
    DirectionForecast::Light light;
    light.jacobian = reported.jacobian.middleRows<2>(at);
    const Eigen::Matrix2d plain = light.jacobian * covariance.matrix * light.jacobian.transpose();
    for (Eigen::Index axis = 0; axis < 2; ++axis)
      light.inflation[axis] =
          plain(axis, axis) > 0.0 ? std::sqrt(stat(at + axis, at + axis) / plain(axis, axis)) : 1.0;
    light.floor = model.block<2, 2>(at, at);
    out.lights.push_back(std::move(light));
  }
  return out;
}

// Items of nothing at all are left out.
std::vector<BudgetItem> BudgetOf(const std::vector<Part>& items, const Eigen::MatrixXd& total,
                                 const std::vector<bool>& undetermined, std::size_t lights) {
  std::vector<BudgetItem> out;
  for (const Part& part : items)
    if ((part.covariance.diagonal().array() > 0.0).any())
      out.push_back({part.words, Unflatten(part.covariance, undetermined, lights, &total)});
  return out;
}

Eigen::MatrixXd WithoutUndetermined(Eigen::MatrixXd covariance,
                                    const std::vector<bool>& undetermined) {
  for (Eigen::Index q = 0; q < covariance.rows(); ++q)
    if (undetermined[static_cast<std::size_t>(q)]) {
      covariance.row(q).setConstant(kUnknown);
      covariance.col(q).setConstant(kUnknown);
    }
  return covariance;
}

}  // namespace

Uncertainties EstimateUncertainty(const solve::Solution& solution,
                                  const observe::Observations& observations,
                                  const std::vector<std::size_t>& order, double views_per_distinct,
                                  const ResidualSplits& splits,
                                  const CalibrationResponse* calibration) {
  const model::Parameters parameters(solution.scene, observations.channels);
  const Covariance covariance = Invert(solution, observations, parameters, views_per_distinct);
  const Propagation reported = Propagate(solution, observations, order, parameters, covariance,
                                         splits.unmodelled.tilted_scene);
  const Parts parts =
      PartsOf(solution, parameters, splits, covariance, reported, views_per_distinct, order);
  std::vector<Part> items{{NoiseWords(), parts.stat}};
  items.insert(items.end(), parts.items.begin(), parts.items.end());
  Eigen::MatrixXd total = parts.stat + parts.model;
  Eigen::MatrixXd of_calibration = Eigen::MatrixXd::Zero(total.rows(), total.cols());
  if (calibration)
    for (Part& part :
         CalibrationParts(*calibration, solution, parameters, covariance, reported, order)) {
      total += part.covariance;
      of_calibration += part.covariance;
      items.push_back(std::move(part));
    }
  Uncertainties out{Unflatten(total, reported.undetermined, order.size()),
                    Unflatten(parts.stat, reported.undetermined, order.size()),
                    WithoutUndetermined(total, reported.undetermined),
                    Unflatten(of_calibration, reported.undetermined, order.size()),
                    BudgetOf(items, total, reported.undetermined, order.size()),
                    FactorSigmas(solution, order, covariance),
                    ForecastOf(solution, parameters, covariance, reported, parts.stat,
                               total - parts.stat, order.size()),
                    parts.count};
  for (Uncertainty* uncertainty : {&out.total, &out.stat}) {
    uncertainty->condition = covariance.condition;
    uncertainty->weak = covariance.weak;
    uncertainty->weak.insert(uncertainty->weak.end(), parts.weak.begin(), parts.weak.end());
  }
  return out;
}

}  // namespace turnlight::estimator::uncertainty
