#include "estimator/uncertainty/uncertainty_parts.h"

#include <algorithm>
#include <cmath>

#include "estimator/model/tangent_basis.h"
#include "estimator/solve/unit_diagonal.h"
#include "estimator/uncertainty/quantities.h"

namespace turnlight::estimator::uncertainty {
namespace {

// Tests: what noise alone may show, in sigmas.
constexpr double kOneNumberSigmas = 3.0;  // of one number
constexpr double kSearchedSigmas = 4.0;   // of the best of many
constexpr double kAllNumbersSigmas =
    4.0;  // of all numbers of a split together, about chi squared's mean
// A variance that is larger by this counts, from however few clusters it was estimated.
constexpr double kMostChanceInflation = 4.0;
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

// The fit, linearised: what makes changes of the reported quantities of gradients.
struct Linearised {
  const Covariance& covariance;
  const Eigen::MatrixXd& jacobian;  // of the reported quantities by the unknowns
  Eigen::MatrixXd inverse;          // H^-1 of the unknowns
  // Variance inflation: by how much the sums of residuals vary more than those of white noise.
  double variance_inflation = 1.0;

  double Variance() const { return covariance.variance * variance_inflation; }
};

// Half the difference of two halves, as far as it is more than noise.
void AddHalf(const Eigen::VectorXd& gradient, const Linearised& fit, Parts& out) {
  const double count = static_cast<double>(gradient.size());
  const double chi = gradient.dot(fit.inverse * gradient) / (fit.Variance());
  const double expected = count + kAllNumbersSigmas * std::sqrt(2.0 * count);
  const double all = chi > expected ? 1.0 - expected / chi : 0.0;
  Eigen::VectorXd shift = fit.jacobian * (fit.inverse * gradient);
  for (Eigen::Index q = 0; q < shift.size(); ++q) {
    const double noise = kOneNumberSigmas * kOneNumberSigmas * out.stat(q, q);
    const double square = shift[q] * shift[q];
    shift[q] *=
        kErrorsInCommon * std::sqrt(std::max(all, square > noise ? 1.0 - noise / square : 0.0));
  }
  out.Add(HalvesWords(), shift);
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

// The same of a number that was searched for, and cannot be negative: all of it, if it is there,
// times `margin`. Gives the test's sigmas.
double AddSearched(const AdjustedScore& score, double margin, const Linearised& fit, Parts& out) {
  if (!(score.slope < 0.0)) return 0.0;
  const double sigmas = std::sqrt(score.Statistic(fit.Variance()));
  if (sigmas > kSearchedSigmas)
    out.Add(LightsWords(),
            margin * score.slope / score.curvature * (fit.jacobian * score.regression));
  return sigmas;
}

// What letting in what the pictures ask for would change.
void AddUnmodelled(const Unmodelled& unmodelled, const Linearised& fit, Parts& out) {
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
  for (std::size_t k = 0; k < unmodelled.extents.size(); ++k) {
    const auto score = adjusted(unmodelled.extents[k], kIdentifiable);
    if (!score) continue;
    const double sigmas = AddSearched(*score, 1.0, fit, out);
    if (sigmas <= out.count.split) continue;
    out.count.split = sigmas;
    out.count.split_light = k / 3;
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

// Where the residuals of neighbours go together by more than chance, variances are larger: the
// clustered ("sandwich") estimate from the gradients of clusters, one in each column. Its own
// variance, if the gradients are normal, is two thirds of the sum of their fourth powers, which for
// a small highlight is that of the few clusters that see it.
void AllowForClusters(const Eigen::MatrixXd& gradients, const Linearised& fit, Parts& out) {
  const Eigen::MatrixXd carried = fit.jacobian * fit.inverse;
  Eigen::ArrayXd squares = Eigen::ArrayXd::Zero(carried.rows()), fourths = squares;
  for (Eigen::Index k = 0; k < gradients.cols(); ++k) {
    const Eigen::ArrayXd square = (carried * gradients.col(k)).array().square();
    squares += square;
    fourths += square.square();
  }
  const Eigen::ArrayXd stat = out.stat.diagonal().array().max(1e-300);
  const Eigen::ArrayXd chance =
      (stat + kOneNumberSigmas * (2.0 / 3.0 * fourths).sqrt()).min(kMostChanceInflation * stat);
  const Eigen::VectorXd more = (squares > chance).select((squares / stat).sqrt(), 1.0).matrix();
  out.stat = more.asDiagonal() * out.stat * more.asDiagonal();
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
  // As many as they are, they have one mean less to vary about.
  const auto corrected = [&](const Eigen::MatrixXd& gradients) {
    const double count = static_cast<double>(gradients.cols());
    return Eigen::MatrixXd(gradients(unknowns, Eigen::all) *
                           std::sqrt(count / std::max(count - 1.0, 1.0)));
  };
  const Eigen::MatrixXd clusters = std::sqrt(views_per_distinct) * corrected(splits.clusters);
  AllowForClusters(clusters, fit, out);
  // Views that repeat are together in a place already.
  if (splits.places.cols() > 0) AllowForClusters(corrected(splits.places), fit, out);
  const double count = static_cast<double>(unknowns.size());
  fit.variance_inflation =
      std::max((clusters.transpose() * fit.inverse).cwiseProduct(clusters.transpose()).sum() /
                   (count * covariance.variance),
               1.0);

  const Eigen::VectorXd whole = solution.equations.gradient(unknowns);
  for (const Eigen::VectorXd& half : splits.halves) AddHalf(2.0 * half(unknowns) - whole, fit, out);
  AddEdges(solution.equations, splits.edges, fit, out);
  out.Add(PixelsWords(), jacobian * (fit.inverse * splits.finer(unknowns)));
  AddUnmodelled(splits.unmodelled, fit, out);
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
