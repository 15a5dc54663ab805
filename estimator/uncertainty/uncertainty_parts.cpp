#include "estimator/uncertainty/uncertainty_parts.h"

#include <algorithm>
#include <cmath>

#include "estimator/solve/unit_diagonal.h"

namespace turnlight::estimator::uncertainty {
namespace {

// Halves share some of the model's errors, which their difference does not show.
constexpr double kCommon = 2.0;
constexpr double kChanceSigmas = 3.0;     // what noise alone may show of one number
constexpr double kBeyondChance = 4.0;     // of a variance, whatever it was estimated from
constexpr double kSearchedSigmas = 4.0;   // of the best of many
constexpr double kCommonRoughness = 0.5;  // radians
constexpr double kUndecided = 1e-5;       // of a column's curvature, beside all others
constexpr double kTold = 0.02;            // of a tilt's curvature, beside everything else
constexpr double kMostWider = 0.95;       // of a lobe's variance that normals make
constexpr double kToldApart = 1e-5;       // of another effect's
constexpr double kExplained = 0.02;       // of the residual variance, by a tilt that counts
constexpr double kJointSigmas = 4.0;      // what noise may show of all numbers of a split

// What makes sigmas of gradients.
struct Scales {
  const Covariance& covariance;
  const Eigen::MatrixXd& jacobian;
  Eigen::MatrixXd inverse;  // H^-1 of the unknowns
  double together = 1.0;    // how much larger than white noise the residuals' sums are
};

void AddShift(const Eigen::VectorXd& shift, Eigen::MatrixXd& model) {
  model += shift * shift.transpose();
}

// Half the difference of two halves, as far as it is more than noise.
void AddHalf(const Eigen::VectorXd& gradient, const Scales& scales, Parts& out) {
  const double count = static_cast<double>(gradient.size());
  const double chi =
      gradient.dot(scales.inverse * gradient) / (scales.covariance.variance * scales.together);
  const double expected = count + kJointSigmas * std::sqrt(2.0 * count);
  const double all = chi > expected ? 1.0 - expected / chi : 0.0;
  Eigen::VectorXd shift = scales.jacobian * (scales.inverse * gradient);
  for (Eigen::Index q = 0; q < shift.size(); ++q) {
    const double noise = kChanceSigmas * kChanceSigmas * out.stat(q, q);
    const double square = shift[q] * shift[q];
    shift[q] *= kCommon * std::sqrt(std::max(all, square > noise ? 1.0 - noise / square : 0.0));
  }
  AddShift(shift, out.model);
}

// What leaving out the pixels near edges changes, as far as it is more than noise.
void AddEdges(const solve::NormalEquations& all, const solve::NormalEquations& edges,
              const Scales& scales, Parts& out) {
  const std::vector<int>& unknowns = scales.covariance.unknowns;
  const solve::ScaledFactor rest((all.hessian - edges.hessian)(unknowns, unknowns));
  if (!rest.Good()) return;  // without them some things are not determined
  Eigen::VectorXd shift = scales.jacobian * rest.Solve(edges.gradient(unknowns));
  for (Eigen::Index q = 0; q < shift.size(); ++q) {
    // Of noise alone the change has the variance of the rest's answer less that of the whole's.
    const Eigen::VectorXd row = scales.jacobian.row(q);
    const double of_rest = scales.covariance.variance * scales.together * row.dot(rest.Solve(row));
    const double noise = kChanceSigmas * kChanceSigmas * std::max(of_rest - out.stat(q, q), 0.0);
    const double square = std::max(shift[q] * shift[q], 1e-300);
    shift[q] *= std::sqrt(std::max(1.0 - noise / square, 0.0));
  }
  AddShift(shift, out.model);
}

// One more parameter that could be free beside the unknowns: the cost's slope and curvature by it
// when they follow, and how they follow.
struct Extra {
  double slope = 0.0, curvature = 0.0;
  Eigen::VectorXd follow;
};

// How far the data ask for it: its step over that step's sigma, squared.
double Significance(const Extra& extra, const Scales& scales) {
  return extra.slope * extra.slope / extra.curvature /
         (scales.covariance.variance * scales.together);
}

// What the unknowns would change by if it were free, as far as that is more than noise.
void AddExtra(const Extra& extra, const Scales& scales, Parts& out) {
  const double noise = kChanceSigmas * kChanceSigmas;
  const double significance = Significance(extra, scales);
  if (significance <= noise) return;
  AddShift(std::sqrt(1.0 - noise / significance) * extra.slope / extra.curvature *
               (scales.jacobian * extra.follow),
           out.model);
}

// The same of what was searched for, and cannot be negative: all of it, if it is there, times
// `coarse`.
void AddSearched(const Extra& extra, double coarse, const Scales& scales, Parts& out) {
  if (extra.slope < 0.0 && Significance(extra, scales) > kSearchedSigmas * kSearchedSigmas)
    AddShift(coarse * extra.slope / extra.curvature * (scales.jacobian * extra.follow), out.model);
}

// What letting in what the pictures ask for would change.
void AddUnmodelled(const Unmodelled& unmodelled, const Scales& scales, Parts& out) {
  const std::vector<int>& unknowns = scales.covariance.unknowns;
  const solve::ScaledFactor sample(unmodelled.as_modelled.hessian(unknowns, unknowns));
  if (!sample.Good()) return;
  const Eigen::VectorXd own = unmodelled.as_modelled.gradient(unknowns);
  // Nothing if the unknowns can follow it anyway: then it is not told apart from them.
  const auto beside = [&](const Effect& effect, double told) -> std::optional<Extra> {
    const Eigen::VectorXd mixed = effect.mixed(unknowns);
    Extra extra;
    extra.follow = sample.Solve(mixed);
    extra.curvature = effect.curvature - mixed.dot(extra.follow);
    extra.slope = effect.slope - extra.follow.dot(own);
    if (!(extra.curvature > told * effect.curvature)) return std::nullopt;
    return extra;
  };
  for (const Effect& tilt : unmodelled.tilts) {
    if (unmodelled.straightened) break;  // known better
    const auto extra = beside(tilt, kTold);
    if (extra && 0.5 * extra->slope * extra->slope / extra->curvature >=
                     kExplained * unmodelled.as_modelled.cost)
      AddExtra(*extra, scales, out);
  }
  if (const auto extra = beside(unmodelled.aperture, kToldApart)) AddExtra(*extra, scales, out);
  for (const Effect& extent : unmodelled.extents)
    if (const auto extra = beside(extent, kToldApart)) AddSearched(*extra, 1.0, scales, out);
  AddShift(scales.jacobian * sample.Solve(unmodelled.falloff(unknowns)), out.model);
  if (!unmodelled.light) return;
  // Its direction is one of a few, 14 degrees apart.
  if (const auto extra = beside(*unmodelled.light, kToldApart))
    AddSearched(*extra, kCommon, scales, out);
}

// Normals that are wrong each by itself widen the highlight as a rougher material would: the
// mirrored ray turns twice as much as the normal, Blinn-Phong's half vector as much.
void AddScatter(double normal_variance, const model::Reflectance& reflectance,
                const solve::Columns& columns, const Scales& scales, Parts& out) {
  const double lobe = reflectance.specular_model == model::SpecularModel::kPhong ? 4.0 : 1.0;
  // Four times: what varies within a pixel, or over many, is not in their variance.
  const double wider =
      -std::log1p(-std::min(4.0 * lobe * normal_variance * reflectance.shininess, kMostWider));
  const std::vector<int>& unknowns = scales.covariance.unknowns;
  Eigen::VectorXd step = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(unknowns.size()));
  for (std::size_t i = 0; i < unknowns.size(); ++i) {
    if (unknowns[i] == columns.LogShininess()) step[static_cast<Eigen::Index>(i)] = wider;
    if (unknowns[i] == columns.Specular())
      step[static_cast<Eigen::Index>(i)] = wider * reflectance.specular;
  }
  AddShift(scales.jacobian * step, out.model);
}

// Diffuse and ambient light are those of the mean albedo; where that is not uniform, a point's own
// differs by so much.
void AddTexture(double texture, const Eigen::VectorXd& values, Parts& out) {
  Eigen::VectorXd shift = Eigen::VectorXd::Zero(values.size());
  for (Eigen::Index q = 0; q + kShared < values.size(); q += kPerLight)
    shift.segment<3>(q + kDiffuseProduct) = texture * values.segment<3>(q + kDiffuseProduct);
  const Eigen::Index shared = values.size() - kShared;
  shift.tail<3>() = texture * values.tail<3>();
  shift.segment<2>(shared + 3) = texture * values.segment<2>(shared + 3);  // ambient, diffuse
  AddShift(shift, out.model);
}

// A column that was held at its lower bound of 0.
Extra ExtraColumn(const solve::NormalEquations& equations, int column, const Scales& scales) {
  const std::vector<int>& unknowns = scales.covariance.unknowns;
  const Eigen::VectorXd mixed = equations.hessian(unknowns, column);
  Extra extra;
  extra.follow = scales.inverse * mixed;
  extra.curvature = std::max(equations.hessian(column, column) - mixed.dot(extra.follow),
                             1e-9 * equations.hessian(column, column));
  extra.slope = equations.gradient[column] - extra.follow.dot(equations.gradient(unknowns));
  return extra;
}

// Lambert was taken. Where the data cannot tell, as on a board under one light, a surface as rough
// as is common is as good, and what it would change belongs to the error.
void AddRoughness(const solve::NormalEquations& equations, const solve::Columns& columns,
                  const Scales& scales, Parts& out) {
  const Extra extra = ExtraColumn(equations, columns.RoughnessSquared(), scales);
  if (!(extra.curvature > 0.0)) return;  // nothing diffuse
  const double alone = equations.hessian(columns.RoughnessSquared(), columns.RoughnessSquared());
  if (extra.curvature < kUndecided * alone) {
    AddShift(kCommonRoughness * kCommonRoughness * (scales.jacobian * extra.follow), out.model);
    out.weak.emplace_back("diffuse against roughness: Lambert was taken");
  } else if (extra.slope < 0.0) {
    AddExtra(extra, scales, out);
  }
}

// What was left out of the model. A positive slope would want to go below the bound.
void AddAlternatives(const solve::NormalEquations& equations, const solve::Columns& columns,
                     const model::Reflectance& reflectance, const Scales& scales, Parts& out) {
  if (reflectance.diffuse_model == model::DiffuseModel::kLambert)
    AddRoughness(equations, columns, scales, out);
  const std::vector<int>& unknowns = scales.covariance.unknowns;
  for (int l = 0; l < columns.lights; ++l) {
    const int column = columns.InverseDistance(l);
    if (std::find(unknowns.begin(), unknowns.end(), column) != unknowns.end()) continue;
    const Extra extra = ExtraColumn(equations, column, scales);
    if (extra.curvature > 0.0 && extra.slope < 0.0) AddExtra(extra, scales, out);
  }
}

// Where the residuals of neighbours go together by more than chance, variances are larger: the
// clustered ("sandwich") estimate from the gradients of clusters, one in each column. Its own
// variance, if the gradients are normal, is two thirds of the sum of their fourth powers, which for
// a small highlight is that of the few clusters that see it.
void AllowForClusters(const Eigen::MatrixXd& gradients, const Scales& scales, Parts& out) {
  const Eigen::MatrixXd carried = scales.jacobian * scales.inverse;
  Eigen::ArrayXd squares = Eigen::ArrayXd::Zero(carried.rows()), fourths = squares;
  for (Eigen::Index k = 0; k < gradients.cols(); ++k) {
    const Eigen::ArrayXd square = (carried * gradients.col(k)).array().square();
    squares += square;
    fourths += square.square();
  }
  const Eigen::ArrayXd stat = out.stat.diagonal().array().max(1e-300);
  const Eigen::ArrayXd chance =
      (stat + kChanceSigmas * (2.0 / 3.0 * fourths).sqrt()).min(kBeyondChance * stat);
  const Eigen::VectorXd more = (squares > chance).select((squares / stat).sqrt(), 1.0).matrix();
  out.stat = more.asDiagonal() * out.stat * more.asDiagonal();
}

}  // namespace

Parts PartsOf(const solve::Solution& solution, const solve::Columns& columns,
              const ResidualSplits& splits, const Covariance& covariance, const Carried& carried,
              double views_per_distinct) {
  const Eigen::MatrixXd& jacobian = carried.jacobian;
  Parts out;
  out.stat = jacobian * covariance.matrix * jacobian.transpose();
  out.model = Eigen::MatrixXd::Zero(out.stat.rows(), out.stat.cols());
  const std::vector<int>& unknowns = covariance.unknowns;
  if (unknowns.empty() || !(covariance.variance > 0.0)) return out;
  Scales scales{covariance, jacobian, covariance.matrix / covariance.variance};
  // As many as they are, they have one mean less to vary about.
  const auto corrected = [&](const Eigen::MatrixXd& gradients) {
    const double count = static_cast<double>(gradients.cols());
    return Eigen::MatrixXd(gradients(unknowns, Eigen::all) *
                           std::sqrt(count / std::max(count - 1.0, 1.0)));
  };
  const Eigen::MatrixXd clusters = std::sqrt(views_per_distinct) * corrected(splits.clusters);
  AllowForClusters(clusters, scales, out);
  // Views that repeat are together in a place already.
  if (splits.places.cols() > 0) AllowForClusters(corrected(splits.places), scales, out);
  const double count = static_cast<double>(unknowns.size());
  scales.together =
      std::max((clusters.transpose() * scales.inverse).cwiseProduct(clusters.transpose()).sum() /
                   (count * covariance.variance),
               1.0);

  const Eigen::VectorXd whole = solution.equations.gradient(unknowns);
  for (const Eigen::VectorXd& half : splits.halves)
    AddHalf(2.0 * half(unknowns) - whole, scales, out);
  AddEdges(solution.equations, splits.edges, scales, out);
  AddShift(jacobian * (scales.inverse * splits.finer(unknowns)), out.model);
  AddUnmodelled(splits.unmodelled, scales, out);
  AddScatter(splits.unmodelled.normal_variance, solution.scene.reflectance, columns, scales, out);
  AddTexture(splits.texture, carried.values, out);
  if (carried.straightened.size() > 0) AddShift(carried.straightened, out.model);
  AddAlternatives(splits.alternatives, columns, solution.scene.reflectance, scales, out);
  return out;
}

}  // namespace turnlight::estimator::uncertainty
