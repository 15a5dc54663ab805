#include "estimator/uncertainty/uncertainty_parts.h"

#include <algorithm>
#include <cmath>

#include "estimator/model/tangent_basis.h"
#include "estimator/solve/unit_diagonal.h"
#include "estimator/uncertainty/clusters.h"
#include "estimator/uncertainty/quantities.h"

namespace turnlight::estimator::uncertainty {
namespace {

// Tests: what noise alone may show, in sigmas.
constexpr double kOneNumberSigmas = 3.0;  // of one number
constexpr double kSearchedSigmas = 4.0;   // of the best of many
constexpr double kAllNumbersSigmas =
    4.0;  // of all numbers of a split together, about chi squared's mean
// Halves share some of the model's errors, which their difference does not show.
constexpr double kErrorsInCommon = 2.0;
// The direction of a light that was searched for is one of a few, 14 degrees apart.
constexpr double kCoarseDirection = 2.0;
// Shares of a number's curvature that must be left beside the nuisance parameters, or it is not
// identifiable beside them: of a tilt, of other numbers, and of roughness.
constexpr double kIdentifiableTilt = 0.02, kIdentifiable = 1e-5, kIdentifiableRoughness = 1e-5;
constexpr double kLeastExplainedByTilt = 0.02;  // of the cost
constexpr double kCommonRoughness = 0.5;        // radians
// Four times the scattered normals' variance: what varies within a pixel, or over many, is not in
// it.
constexpr double kScatterMargin = 4.0;
constexpr double kMostWidening = 0.95;  // of a lobe's variance, by scattered normals

// Half the difference of two halves, as far as it is more than noise, times `margin`.
void AddHalf(const Eigen::VectorXd& gradient, double margin, const Linearised& fit, Parts& out) {
  const double count = static_cast<double>(gradient.size());
  const double chi = gradient.dot(fit.inverse * gradient) / (fit.Variance());
  const double expected = count + kAllNumbersSigmas * std::sqrt(2.0 * count);
  const double all = chi > expected ? 1.0 - expected / chi : 0.0;
  Eigen::VectorXd shift = fit.jacobian * (fit.inverse * gradient);
  for (Eigen::Index q = 0; q < shift.size(); ++q) {
    const double noise = kOneNumberSigmas * kOneNumberSigmas * out.stat(q, q);
    const double square = shift[q] * shift[q];
    shift[q] *= margin * std::sqrt(std::max(all, square > noise ? 1.0 - noise / square : 0.0));
  }
  out.Add(HalvesWords(), shift);
}

// Where squares tell already what goes together, halves are so many looks at one thing: their mean
// counts, not their sum.
void AddHalves(const std::vector<Eigen::VectorXd>& halves, const Eigen::VectorXd& whole,
               const Linearised& fit, Parts& out) {
  const double looks = fit.unexplained_view ? static_cast<double>(halves.size()) : 1.0;
  for (const Eigen::VectorXd& half : halves)
    AddHalf(2.0 * half(fit.covariance.unknowns) - whole, kErrorsInCommon / std::sqrt(looks), fit,
            out);
}

// What leaving out the pixels near edges changes, as far as it is more than noise.
void AddEdges(const solve::NormalEquations& all, const solve::NormalEquations& edges,
              const Linearised& fit, Parts& out) {
  const std::vector<int>& unknowns = fit.covariance.unknowns;
  const solve::ScaledFactor rest((all.hessian - edges.hessian)(unknowns, unknowns));
  if (!rest.Good()) return;  // without them some things are not determined
  Eigen::VectorXd shift = fit.jacobian * rest.Solve(edges.gradient(unknowns));
  for (Eigen::Index q = 0; q < shift.size(); ++q) {
    // Of noise alone the change has the variance of the rest's answer less that of the whole's.
    const Eigen::VectorXd row = fit.jacobian.row(q);
    const double of_rest = fit.Variance() * row.dot(rest.Solve(row));
    const double noise =
        kOneNumberSigmas * kOneNumberSigmas * std::max(of_rest - out.stat(q, q), 0.0);
    const double square = std::max(shift[q] * shift[q], 1e-300);
    shift[q] *= std::sqrt(std::max(1.0 - noise / square, 0.0));
  }
  out.Add(EdgesWords(), shift);
}

// What the unknowns would change by if the tested number were free, as far as that is more than
// noise.
void AddIfSignificant(const BudgetWords& words, const AdjustedScore& score, const Linearised& fit,
                      Parts& out) {
  const double noise = kOneNumberSigmas * kOneNumberSigmas;
  const double statistic = score.Statistic(fit.Variance());
  if (statistic <= noise) return;
  out.Add(words, std::sqrt(1.0 - noise / statistic) * score.slope / score.curvature *
                     (fit.jacobian * score.regression));
}

// How far a number that cannot be negative is above 0.
double SigmasAbove(const AdjustedScore& score, double variance) {
  return score.slope < 0.0 ? std::sqrt(score.Statistic(variance)) : 0.0;
}

// The same of a number that was searched for, and cannot be negative: all of it, if it is there,
// times `margin`. Gives the test's sigmas by tiles: the number of lights is said to be uncertain
// rather too often.
double AddSearched(const AdjustedScore& score, double margin, const Linearised& fit, Parts& out) {
  if (SigmasAbove(score, fit.Variance()) > kSearchedSigmas)
    out.Add(LightsWords(),
            margin * score.slope / score.curvature * (fit.jacobian * score.regression));
  return SigmasAbove(score, fit.covariance.variance * fit.tile_inflation);
}

// What is told as one light may be two, apart by twice the square root of its extent: each is as
// far from where the one is. Of extents along an axis, in the tangent plane of the light's
// direction, the largest beyond one sigma counts.
void AddSplit(const std::array<std::optional<AdjustedScore>, 3>& extents, Eigen::Index direction,
              const Linearised& fit, Parts& out) {
  double most = 0.0;
  std::size_t axis = 0;
  for (std::size_t k = 0; k < extents.size(); ++k) {
    const double sigmas = extents[k] ? SigmasAbove(*extents[k], fit.Variance()) : 0.0;
    if (!(sigmas > 1.0)) continue;
    const double beyond =
        (1.0 - 1.0 / (sigmas * sigmas)) * -extents[k]->slope / extents[k]->curvature;
    if (beyond > most) most = beyond, axis = k;
  }
  const double angle = ExtentAxis(axis);
  Eigen::VectorXd shift = Eigen::VectorXd::Zero(out.stat.rows());
  shift.segment<2>(direction) = std::sqrt(most) * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  out.Add(LightsWords(), shift);
}

// What letting in what the pictures ask for would change.
void AddUnmodelled(const Unmodelled& unmodelled, const std::vector<std::size_t>& order,
                   const Linearised& fit, Parts& out) {
  const std::vector<int>& unknowns = fit.covariance.unknowns;
  const solve::ScaledFactor information(unmodelled.as_modelled.hessian(unknowns, unknowns));
  if (!information.Good()) return;
  const Eigen::VectorXd own = unmodelled.as_modelled.gradient(unknowns);
  // None if the nuisance parameters take nearly all of it up: then it is not identifiable.
  const auto adjusted = [&](const Score& score, double least) -> std::optional<AdjustedScore> {
    const Eigen::VectorXd cross_hessian = score.cross_hessian(unknowns);
    AdjustedScore out;
    out.regression = information.Solve(cross_hessian);
    out.curvature = score.curvature - cross_hessian.dot(out.regression);
    out.slope = score.slope - out.regression.dot(own);
    if (!(out.curvature > least * score.curvature)) return std::nullopt;
    return out;
  };
  for (const Score& tilt : unmodelled.tilts) {
    if (unmodelled.tilted_scene) break;  // known better
    const auto score = adjusted(tilt, kIdentifiableTilt);
    if (score && 0.5 * score->slope * score->slope / score->curvature >=
                     kLeastExplainedByTilt * unmodelled.as_modelled.cost)
      AddIfSignificant(NormalsWords(), *score, fit, out);
  }
  if (const auto score = adjusted(unmodelled.aperture, kIdentifiable))
    AddIfSignificant(PixelsWords(), *score, fit, out);
  for (std::size_t i = 0; i < order.size(); ++i) {
    std::array<std::optional<AdjustedScore>, 3> extents;
    for (std::size_t axis = 0; axis < extents.size(); ++axis) {
      extents[axis] = adjusted(unmodelled.extents[order[i]][axis], kIdentifiable);
      if (!extents[axis]) continue;
      const double sigmas = AddSearched(*extents[axis], 1.0, fit, out);
      if (sigmas <= out.count.split) continue;
      out.count.split = sigmas;
      out.count.split_light = i;
    }
    if (fit.unexplained_view) AddSplit(extents, At(OfLight::kDirection, i), fit, out);
  }
  out.Add(PixelsWords(), fit.jacobian * information.Solve(unmodelled.falloff(unknowns)));
  if (!unmodelled.light) return;
  if (const auto score = adjusted(*unmodelled.light, kIdentifiable)) {
    out.count.further = AddSearched(*score, kCoarseDirection, fit, out);
    out.count.further_direction = unmodelled.light_direction;
  }
}

// Normals that are wrong each by itself widen the highlight as a rougher material would: the
// mirrored ray turns twice as much as the normal, Blinn-Phong's half vector as much.
void AddScatter(double normal_variance, const model::Reflectance& reflectance,
                const model::Parameters& parameters, const Linearised& fit, Parts& out) {
  const std::vector<int>& unknowns = fit.covariance.unknowns;
  Eigen::VectorXd step = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(unknowns.size()));
  for (int k = 0; k < parameters.lobes(); ++k) {
    const model::Lobe& lobe = reflectance.lobes[static_cast<std::size_t>(k)];
    if (!lobe.present()) continue;
    const double twice = model::FactsOf(lobe.model).about_mirrored_view ? 4.0 : 1.0;
    const double share =
        kScatterMargin * twice * normal_variance * model::LobeInverseVariance(lobe);
    const double widening = -std::log1p(-std::min(share, kMostWidening));
    const model::LobeSlopes slopes = model::LobeSlopesOf(lobe);
    for (std::size_t i = 0; i < unknowns.size(); ++i) {
      double& to = step[static_cast<Eigen::Index>(i)];
      if (unknowns[i] == parameters.Shape(k)) to = widening * slopes.log_shape;
      if (unknowns[i] == parameters.Strength(k)) to = widening * slopes.strength;
    }
  }
  out.Add(NormalsWords(), fit.jacobian * step);
}

// Diffuse and ambient light are those of the mean albedo; where that is not uniform, a point's own
// differs by so much.
void AddTexture(double texture, const Eigen::VectorXd& values, std::size_t lights, Parts& out) {
  Eigen::VectorXd shift = Eigen::VectorXd::Zero(values.size());
  const auto scale = [&](Eigen::Index at, Eigen::Index size) {
    shift.segment(at, size) = texture * values.segment(at, size);
  };
  for (std::size_t l = 0; l < lights; ++l)
    scale(At(OfLight::kDiffuseProduct, l), SizeOf(OfLight::kDiffuseProduct));
  for (const OfTarget quantity :
       {OfTarget::kAmbient, OfTarget::kDiffuse, OfTarget::kAmbientProduct, OfTarget::kHarmonics})
    scale(At(quantity, lights), SizeOf(quantity));
  out.Add(SurfaceWords(), shift);
}

// Of a column that was held at its lower bound of 0.
AdjustedScore ScoreOfColumn(const solve::NormalEquations& equations, int column,
                            const Linearised& fit) {
  const std::vector<int>& unknowns = fit.covariance.unknowns;
  const Eigen::VectorXd cross_hessian = equations.hessian(unknowns, column);
  AdjustedScore score;
  score.regression = fit.inverse * cross_hessian;
  score.curvature =
      std::max(equations.hessian(column, column) - cross_hessian.dot(score.regression),
               1e-9 * equations.hessian(column, column));
  score.slope = equations.gradient[column] - score.regression.dot(equations.gradient(unknowns));
  return score;
}

// Lambert was taken. Where the data cannot tell, as on a board under one light, a surface as rough
// as is common is as good, and what it would change belongs to the error.
void AddRoughness(const solve::NormalEquations& equations, const model::Parameters& parameters,
                  const Linearised& fit, Parts& out) {
  const int column = parameters.Roughness();
  const AdjustedScore score = ScoreOfColumn(equations, column, fit);
  if (!(score.curvature > 0.0)) return;  // nothing diffuse
  if (score.curvature < kIdentifiableRoughness * equations.hessian(column, column)) {
    out.Add(SurfaceWords(),
            kCommonRoughness * kCommonRoughness * (fit.jacobian * score.regression));
    out.weak.emplace_back("diffuse against roughness: Lambert was taken");
  } else if (score.slope < 0.0) {
    AddIfSignificant(SurfaceWords(), score, fit, out);
  }
}

// What was left out of the model. A positive slope would want to go below the bound.
void AddAlternatives(const solve::NormalEquations& equations, const model::Parameters& parameters,
                     const model::Reflectance& reflectance, const Linearised& fit, Parts& out) {
  if (reflectance.diffuse_model == model::DiffuseModel::kLambert)
    AddRoughness(equations, parameters, fit, out);
  const std::vector<int>& unknowns = fit.covariance.unknowns;
  for (int l = 0; l < parameters.lights(); ++l) {
    const int column = parameters.InverseDistance(l);
    if (std::find(unknowns.begin(), unknowns.end(), column) != unknowns.end()) continue;
    const AdjustedScore score = ScoreOfColumn(equations, column, fit);
    if (score.curvature > 0.0 && score.slope < 0.0)
      AddIfSignificant(LightsWords(), score, fit, out);
  }
}

// Of lights in their reported order; of their directions alone.
void AddPhotographErrors(const PhotographErrors& errors, const model::Scene& scene,
                         const std::vector<std::size_t>& order, Parts& out) {
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::size_t l = order[i];
    const Eigen::Index at = At(OfLight::kDirection, i);
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(out.stat.rows());
    for (int axis = 0; axis < 2; ++axis) {
      Eigen::VectorXd shift = none;
      shift[at + axis] = errors.place[l];
      out.Add(HighlightsWords(), shift);
    }
    Eigen::VectorXd shift = none;
    shift.segment<2>(at) =
        model::TangentBasis(scene.lights[l].direction).transpose() * errors.distance[l];
    out.Add(DistanceWords(), shift);
  }
}

// By how much a light's inverse distance, held at 0, would follow a change of the gradient with the
// unknowns. 0 if it is an unknown itself, or not identifiable beside them.
double HeldDistanceShift(const solve::NormalEquations& equations, const Eigen::VectorXd& gradient,
                         int column, std::vector<int> unknowns) {
  if (std::find(unknowns.begin(), unknowns.end(), column) != unknowns.end()) return 0.0;
  unknowns.push_back(column);
  const solve::ScaledFactor factor(equations.hessian(unknowns, unknowns));
  return factor.Good() ? factor.Solve(Eigen::VectorXd(gradient(unknowns))).tail<1>().value() : 0.0;
}

}  // namespace

void Parts::Add(const BudgetWords& words, const Eigen::VectorXd& shift) {
  const Eigen::MatrixXd square = shift * shift.transpose();
  model += square;
  const auto item = std::find_if(items.begin(), items.end(),
                                 [&](const Part& part) { return part.words.item == words.item; });
  if (item != items.end())
    item->covariance += square;
  else
    items.push_back({words, square});
}

Parts PartsOf(const solve::Solution& solution, const model::Parameters& parameters,
              const ResidualSplits& splits, const Covariance& covariance,
              const Propagation& reported, double views_per_distinct,
              const std::vector<std::size_t>& order) {
  const Eigen::MatrixXd& jacobian = reported.jacobian;
  Parts out;
  out.stat = jacobian * covariance.matrix * jacobian.transpose();
  out.model = Eigen::MatrixXd::Zero(out.stat.rows(), out.stat.cols());
  const std::vector<int>& unknowns = covariance.unknowns;
  if (unknowns.empty() || !(covariance.variance > 0.0)) return out;
  if (splits.photograph) {
    AddPhotographErrors(*splits.photograph, solution.scene, order, out);
    return out;
  }
  Linearised fit{covariance, jacobian, covariance.matrix / covariance.variance};
  AllowForClusters(splits, views_per_distinct, fit, out.stat);

  AddHalves(splits.halves, solution.equations.gradient(unknowns), fit, out);
  AddEdges(solution.equations, splits.edges, fit, out);
  out.Add(PixelsWords(), jacobian * (fit.inverse * splits.finer(unknowns)));
  AddUnmodelled(splits.unmodelled, order, fit, out);
  AddScatter(splits.unmodelled.normal_variance, solution.scene.reflectance, parameters, fit, out);
  AddTexture(splits.texture, reported.values, solution.scene.lights.size(), out);
  if (reported.tilt_shift.size() > 0) out.Add(NormalsWords(), reported.tilt_shift);
  AddAlternatives(splits.alternatives, parameters, solution.scene.reflectance, fit, out);
  return out;
}

std::vector<Part> CalibrationParts(const CalibrationResponse& calibration,
                                   const solve::Solution& solution,
                                   const model::Parameters& parameters,
                                   const Covariance& covariance, const Propagation& reported,
                                   const std::vector<std::size_t>& order) {
  const Eigen::Index quantities = reported.jacobian.rows();
  const std::vector<int>& unknowns = covariance.unknowns;
  std::vector<Part> out;
  for (const CalibrationResponse::Item& item : calibration.items)
    out.push_back({item.words, Eigen::MatrixXd::Zero(quantities, quantities)});
  if (unknowns.empty()) return out;
  // A sample that does not determine all is asked by the steps of the whole.
  const solve::ScaledFactor sample(calibration.as_modelled.hessian(unknowns, unknowns));
  const Eigen::MatrixXd whole =
      covariance.matrix / std::max(covariance.variance, 1e-300) *
      (solution.equations.hessian(unknowns, unknowns).trace() /
       std::max(calibration.as_modelled.hessian(unknowns, unknowns).trace(), 1e-300));
  for (std::size_t k = 0; k < out.size(); ++k) {
    const Eigen::MatrixXd& gradients = calibration.items[k].gradients;
    for (Eigen::Index d = 0; d < gradients.cols(); ++d) {
      const Eigen::VectorXd gradient = gradients.col(d)(unknowns);
      Eigen::VectorXd shift =
          reported.jacobian * (sample.Good() ? Eigen::VectorXd(sample.Solve(gradient))
                                             : Eigen::VectorXd(whole * gradient));
      for (std::size_t i = 0; i < order.size(); ++i)
        shift[At(OfLight::kInverseDistance, i)] +=
            HeldDistanceShift(calibration.as_modelled, gradients.col(d),
                              parameters.InverseDistance(static_cast<int>(order[i])), unknowns) /
            reported.radius;
      out[k].covariance += shift * shift.transpose();
    }
  }
  return out;
}

}  // namespace turnlight::estimator::uncertainty
