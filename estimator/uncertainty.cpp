#include "estimator/uncertainty.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "estimator/residual_splits.h"

namespace turnlight::estimator {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
// Eigenvalues of the column-scaled matrix below this share of the largest are rounding: the data
// say nothing about that direction.
constexpr double kNullShare = 1e-11;
constexpr double kWeakShare = 1e-7;
// Halves share some of the model's errors, which their difference does not show.
constexpr double kCommon = 2.0;
constexpr double kExtraSigmas = 2.0;
constexpr double kSearchedSigmas = 4.0;   // of the best of many
constexpr double kCommonRoughness = 0.5;  // radians
constexpr double kUndecided = 1e-5;       // of a column's curvature, beside all others
constexpr double kTold = 0.02;            // of a tilt's curvature, beside everything else
constexpr double kMostWider = 0.95;       // of a lobe's variance that normals make
constexpr double kToldApart = 1e-5;       // of another effect's
constexpr double kExplained = 0.02;       // of the residual variance, by a tilt that counts
constexpr double kJointSigmas = 4.0, kOwnSigmas = 3.0;  // what a split may show by noise alone

// The columns that count as unknowns: all that are not held. What ended at a bound could be on this
// side of it.
std::vector<int> Unknowns(const Solution& solution, const Columns& columns) {
  std::vector<int> unknowns;
  for (int column = 0; column < columns.count(); ++column) {
    const bool nowhere =
        column == columns.LogShininess() && !(solution.scene.reflectance.specular > 0.0);
    if (!solution.held[static_cast<std::size_t>(column)] && !nowhere) unknowns.push_back(column);
  }
  return unknowns;
}

std::string ColumnName(const Columns& columns, int column) {
  static const char* const kColours[] = {"red", "green", "blue"};
  if (column < columns.channels) return std::string("albedo ") + kColours[column];
  if (column == columns.Ambient()) return "ambient";
  if (column == columns.Diffuse()) return "diffuse";
  if (column == columns.Specular()) return "specular";
  if (column == columns.LogShininess()) return "shininess";
  if (column == columns.RoughnessSquared()) return "roughness";
  const int light = (column - columns.Intensity(0)) / 4;
  const char* const what[] = {"intensity", "direction", "direction", "distance"};
  return std::string(what[(column - columns.Intensity(0)) % 4]) + " of light " +
         std::to_string(light + 1);
}

// Inverse of the information matrix over the unknowns; columns that are not determined are NaN.
struct Covariance {
  std::vector<int> unknowns;
  Eigen::MatrixXd matrix;
  std::vector<bool> undetermined;
  double condition = 0.0;
  std::vector<std::string> weak;
  double variance = 0.0;  // of a value; matrix is this times H^-1
};

std::string NameOf(const Eigen::VectorXd& direction, const std::vector<int>& unknowns,
                   const Columns& columns) {
  std::string text;
  for (Eigen::Index i = 0; i < direction.size(); ++i)
    if (std::abs(direction[i]) > 0.3) {
      const std::string name = ColumnName(columns, unknowns[static_cast<std::size_t>(i)]);
      if (text.find(name) == std::string::npos) text += (text.empty() ? "" : " against ") + name;
    }
  return text;
}

Covariance Invert(const Solution& solution, const Observations& observations,
                  const Columns& columns, const SolveOptions& options) {
  Covariance out;
  out.unknowns = Unknowns(solution, columns);
  const auto n = static_cast<Eigen::Index>(out.unknowns.size());
  Eigen::VectorXd scale(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const int column = out.unknowns[static_cast<std::size_t>(i)];
    scale[i] = std::sqrt(std::max(solution.equations.hessian(column, column), 0.0));
  }
  out.undetermined.assign(static_cast<std::size_t>(n), false);
  out.matrix = Eigen::MatrixXd::Zero(n, n);
  Eigen::MatrixXd scaled(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j) {
      const double s = scale[i] * scale[j];
      scaled(i, j) = s > 0.0
                         ? solution.equations.hessian(out.unknowns[static_cast<std::size_t>(i)],
                                                      out.unknowns[static_cast<std::size_t>(j)]) /
                               s
                         : 0.0;
    }
  if (n == 0) return out;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
  const double largest = std::max(eigen.eigenvalues().maxCoeff(), 1e-300);
  const double values = ValueCount(observations, solution.evaluate);
  const double variance = options.redundancy * 2.0 * solution.equations.cost /
                          std::max(values - static_cast<double>(n), 1.0);
  out.variance = variance;
  double smallest = largest;
  for (Eigen::Index k = 0; k < n; ++k) {
    const double value = eigen.eigenvalues()[k];
    const Eigen::VectorXd vector = eigen.eigenvectors().col(k);
    if (value < kWeakShare * largest) out.weak.push_back(NameOf(vector, out.unknowns, columns));
    if (!(value > kNullShare * largest)) {
      for (Eigen::Index i = 0; i < n; ++i)
        if (std::abs(vector[i]) > 1e-3) out.undetermined[static_cast<std::size_t>(i)] = true;
      continue;
    }
    smallest = std::min(smallest, value);
    out.matrix += variance / value * (vector * vector.transpose());
  }
  out.condition = largest / smallest;
  const Eigen::VectorXd inverse = scale.unaryExpr([](double s) { return s > 0.0 ? 1.0 / s : 0.0; });
  out.matrix = inverse.asDiagonal() * out.matrix * inverse.asDiagonal();
  return out;
}

// The reported quantities as one vector, directions by their tangent coordinates at the solution.
constexpr Eigen::Index kPerLight = 13, kShared = 11, kDiffuseProduct = 4;

Eigen::VectorXd Flatten(const Reported& reported, const Reported& at) {
  const auto lights = static_cast<Eigen::Index>(reported.lights.size());
  Eigen::VectorXd out(kPerLight * lights + kShared);
  for (Eigen::Index l = 0; l < lights; ++l) {
    const ReportedLight& light = reported.lights[static_cast<std::size_t>(l)];
    const Eigen::Vector3d& u = light.light.direction;
    const double rho = light.light.inverse_distance;
    const double rho_at = at.lights[static_cast<std::size_t>(l)].light.inverse_distance;
    const double safe = rho_at > 0.0 ? rho : 1.0;
    out.segment(kPerLight * l, kPerLight)
        << TangentBasis(at.lights[static_cast<std::size_t>(l)].light.direction).transpose() * u,
        rho, light.light.intensity, light.diffuse_product, light.specular_product, u / safe,
        1.0 / safe, light.inverse_distance_at_reference;
  }
  const Reflectance& r = reported.reflectance;
  out.tail(kShared) << r.albedo, r.ambient, r.diffuse, r.specular, r.shininess, r.roughness,
      reported.ambient_product;
  return out;
}

double LargerEigenvalue(const Eigen::Matrix2d& m) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(m).eigenvalues().maxCoeff();
}

// Derivatives of the reported quantities by the unknowns, and which depend on what is undetermined.
struct Carried {
  Eigen::VectorXd values;
  Eigen::MatrixXd jacobian;
  std::vector<bool> unknown;
  Eigen::VectorXd straightened;  // what a large tilt of the normals changes; empty: there is none
};

Carried CarryOver(const Solution& solution, const Observations& observations,
                  const std::vector<std::size_t>& order, const Columns& columns,
                  const Covariance& covariance, const std::optional<Scene>& straightened) {
  const Reported at = Report(solution.scene, observations, order);
  const Eigen::VectorXd values = Flatten(at, at);
  const auto n = static_cast<Eigen::Index>(covariance.unknowns.size());
  Carried out{values,
              Eigen::MatrixXd::Zero(values.size(), n),
              std::vector<bool>(static_cast<std::size_t>(values.size()), false),
              {}};
  if (straightened)
    out.straightened = Flatten(Report(*straightened, observations, order), at) - values;
  for (Eigen::Index i = 0; i < n; ++i) {
    const int column = covariance.unknowns[static_cast<std::size_t>(i)];
    const bool undetermined = covariance.undetermined[static_cast<std::size_t>(i)];
    const double sigma = std::sqrt(covariance.matrix(i, i));
    const double step = undetermined || !(sigma > 0.0) ? 1e-6 : std::min(1e-3 * sigma, 1e-4);
    const auto moved = [&](double by) {
      const Eigen::VectorXd by_column = by * Eigen::VectorXd::Unit(columns.count(), column);
      return Flatten(Report(Moved(solution.scene, columns, by_column), observations, order), at);
    };
    out.jacobian.col(i) = (moved(step) - moved(-step)) / (2.0 * step);
    if (undetermined)
      for (Eigen::Index q = 0; q < values.size(); ++q)
        if (std::abs(out.jacobian(q, i)) > 1e-6 * std::abs(values[q]))
          out.unknown[static_cast<std::size_t>(q)] = true;
  }
  return out;
}

// Covariances of the reported quantities.
struct Parts {
  Eigen::MatrixXd stat, model;
  std::vector<std::string> weak;  // what the model left out and the data do not decide
};

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
    const double noise = kOwnSigmas * kOwnSigmas * out.stat(q, q);
    const double square = shift[q] * shift[q];
    shift[q] *= kCommon * std::sqrt(std::max(all, square > noise ? 1.0 - noise / square : 0.0));
  }
  AddShift(shift, out.model);
}

// The normal equations' matrix over the unknowns, ready to be solved with; scaled to unit diagonal.
struct Factors {
  Eigen::VectorXd scale;
  Eigen::LLT<Eigen::MatrixXd> llt;

  explicit Factors(const Eigen::MatrixXd& matrix)
      : scale(matrix.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse()),
        llt(scale.asDiagonal() * matrix * scale.asDiagonal()) {}
  bool Good() const { return llt.info() == Eigen::Success; }
  Eigen::VectorXd Solve(const Eigen::VectorXd& right) const {
    return scale.asDiagonal() * llt.solve(scale.asDiagonal() * right);
  }
};

// What leaving out the pixels near edges changes, as far as it is more than noise.
void AddEdges(const NormalEquations& all, const NormalEquations& edges, const Scales& scales,
              Parts& out) {
  const std::vector<int>& unknowns = scales.covariance.unknowns;
  const Factors rest((all.hessian - edges.hessian)(unknowns, unknowns));
  if (!rest.Good()) return;  // without them some things are not determined
  Eigen::VectorXd shift = scales.jacobian * rest.Solve(edges.gradient(unknowns));
  for (Eigen::Index q = 0; q < shift.size(); ++q) {
    const double square = std::max(shift[q] * shift[q], 1e-300);
    shift[q] *= std::sqrt(std::max(1.0 - out.stat(q, q) / square, 0.0));
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
void AddExtra(const Extra& extra, double sigmas, const Scales& scales, Parts& out) {
  const double noise = sigmas * sigmas;
  const double significance = Significance(extra, scales);
  if (significance <= noise) return;
  AddShift(std::sqrt(1.0 - noise / significance) * extra.slope / extra.curvature *
               (scales.jacobian * extra.follow),
           out.model);
}

// What letting in what the pictures ask for would change.
void AddUnmodelled(const Unmodelled& unmodelled, const Scales& scales, Parts& out) {
  const std::vector<int>& unknowns = scales.covariance.unknowns;
  const Factors sample(unmodelled.as_modelled.hessian(unknowns, unknowns));
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
      AddExtra(*extra, kExtraSigmas, scales, out);
  }
  if (const auto extra = beside(unmodelled.aperture, kToldApart))
    AddExtra(*extra, kExtraSigmas, scales, out);
  for (const Effect& extent : unmodelled.extents)
    if (const auto extra = beside(extent, kToldApart); extra && extra->slope < 0.0)
      AddExtra(*extra, kSearchedSigmas, scales, out);
  AddShift(scales.jacobian * sample.Solve(unmodelled.falloff(unknowns)), out.model);
  if (!unmodelled.light) return;
  if (const auto extra = beside(*unmodelled.light, kToldApart); extra && extra->slope < 0.0)
    AddExtra(*extra, kSearchedSigmas, scales, out);
}

// Normals that are wrong each by itself widen the highlight as a rougher material would: the
// mirrored ray turns twice as much as the normal, Blinn-Phong's half vector as much.
void AddScatter(double normal_variance, const Reflectance& reflectance, const Columns& columns,
                const Scales& scales, Parts& out) {
  const double lobe = reflectance.specular_model == SpecularModel::kPhong ? 4.0 : 1.0;
  // Twice: their variance is not known well.
  const double wider =
      -std::log1p(-std::min(2.0 * lobe * normal_variance * reflectance.shininess, kMostWider));
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
Extra ExtraColumn(const NormalEquations& equations, int column, const Scales& scales) {
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
void AddRoughness(const NormalEquations& equations, const Columns& columns, const Scales& scales,
                  Parts& out) {
  const Extra extra = ExtraColumn(equations, columns.RoughnessSquared(), scales);
  if (!(extra.curvature > 0.0)) return;  // nothing diffuse
  const double alone = equations.hessian(columns.RoughnessSquared(), columns.RoughnessSquared());
  if (extra.curvature < kUndecided * alone) {
    AddShift(kCommonRoughness * kCommonRoughness * (scales.jacobian * extra.follow), out.model);
    out.weak.emplace_back("diffuse against roughness: Lambert was taken");
  } else if (extra.slope < 0.0) {
    AddExtra(extra, kExtraSigmas, scales, out);
  }
}

// What was left out of the model. A positive slope would want to go below the bound.
void AddAlternatives(const NormalEquations& equations, const Columns& columns,
                     const Reflectance& reflectance, const Scales& scales, Parts& out) {
  if (reflectance.diffuse_model == DiffuseModel::kLambert)
    AddRoughness(equations, columns, scales, out);
  const std::vector<int>& unknowns = scales.covariance.unknowns;
  for (int l = 0; l < columns.lights; ++l) {
    const int column = columns.InverseDistance(l);
    if (std::find(unknowns.begin(), unknowns.end(), column) != unknowns.end()) continue;
    const Extra extra = ExtraColumn(equations, column, scales);
    if (extra.curvature > 0.0 && extra.slope < 0.0) AddExtra(extra, kExtraSigmas, scales, out);
  }
}

// Clustered: where the residuals of neighbours go together, variances are larger.
void AllowForClusters(const Eigen::MatrixXd& outer, const Scales& scales, Parts& out) {
  const Eigen::MatrixXd carried = scales.jacobian * scales.inverse;
  const Eigen::VectorXd sandwich = (carried * outer * carried.transpose()).diagonal();
  const Eigen::VectorXd more =
      (sandwich.array() / out.stat.diagonal().array().max(1e-300)).max(1.0).sqrt();
  out.stat = more.asDiagonal() * out.stat * more.asDiagonal();
}

Parts PartsOf(const Solution& solution, const Columns& columns, const ResidualSplits& splits,
              const Covariance& covariance, const Carried& carried, double redundancy) {
  const Eigen::MatrixXd& jacobian = carried.jacobian;
  Parts out;
  out.stat = jacobian * covariance.matrix * jacobian.transpose();
  out.model = Eigen::MatrixXd::Zero(out.stat.rows(), out.stat.cols());
  const std::vector<int>& unknowns = covariance.unknowns;
  if (unknowns.empty() || !(covariance.variance > 0.0)) return out;
  Scales scales{covariance, jacobian, covariance.matrix / covariance.variance};
  const double clusters = static_cast<double>(splits.cluster_count);
  const Eigen::MatrixXd outer =
      splits.clusters(unknowns, unknowns) * (redundancy * clusters / std::max(clusters - 1.0, 1.0));
  AllowForClusters(outer, scales, out);
  const double count = static_cast<double>(unknowns.size());
  scales.together = std::max((scales.inverse * outer).trace() / (count * covariance.variance), 1.0);

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

Uncertainty Unflatten(const Eigen::MatrixXd& result, const std::vector<bool>& unknown,
                      std::size_t lights) {
  const auto is_unknown = [&](Eigen::Index q) { return unknown[static_cast<std::size_t>(q)]; };
  const auto sigma = [&](Eigen::Index q) {
    return is_unknown(q) ? kUnknown : std::sqrt(std::max(result(q, q), 0.0));
  };
  const auto sigma3 = [&](Eigen::Index q) {
    return Eigen::Vector3d(sigma(q), sigma(q + 1), sigma(q + 2));
  };
  Uncertainty out;
  for (Eigen::Index l = 0; l < static_cast<Eigen::Index>(lights); ++l) {
    const Eigen::Index q = kPerLight * l;
    LightSigma& light = out.lights.emplace_back();
    light.direction = is_unknown(q) || is_unknown(q + 1)
                          ? kUnknown
                          : std::sqrt(LargerEigenvalue(result.block<2, 2>(q, q)));
    light.inverse_distance = sigma(q + 2);
    light.intensity = sigma(q + 3);
    light.diffuse_product = sigma3(q + 4);
    light.specular_product = sigma(q + 7);
    light.position_covariance = result.block<3, 3>(q + 8, q + 8);
    light.distance = sigma(q + 11);
    light.inverse_distance_at_reference = sigma(q + 12);
  }
  const Eigen::Index s = kPerLight * static_cast<Eigen::Index>(lights);
  out.albedo = sigma3(s);
  out.ambient = sigma(s + 3);
  out.diffuse = sigma(s + 4);
  out.specular = sigma(s + 5);
  out.shininess = sigma(s + 6);
  out.roughness = sigma(s + 7);
  out.ambient_product = sigma3(s + 8);
  return out;
}

}  // namespace

std::vector<std::size_t> StrengthOrder(const Scene& solver_scene,
                                       const Observations& observations) {
  const Scene world = ToWorld(solver_scene, observations);
  std::vector<std::size_t> order(world.lights.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return world.lights[a].intensity > world.lights[b].intensity;
  });
  return order;
}

Reported Report(const Scene& solver_scene, const Observations& observations,
                const std::vector<std::size_t>& order) {
  const Scene world = ToWorld(solver_scene, observations);
  Reported out;
  Reflectance& r = out.reflectance;
  r = world.reflectance;
  const double albedo = std::max(r.albedo.maxCoeff(), 1e-300);
  const double strongest = order.empty() ? 1.0 : std::max(world.lights[order[0]].intensity, 1e-300);
  r.albedo /= albedo;
  r.ambient *= albedo;
  r.diffuse *= albedo * strongest;
  r.specular *= strongest;
  out.ambient_product = r.albedo * r.ambient;
  for (const std::size_t index : order) {
    ReportedLight& light = out.lights.emplace_back();
    light.light = world.lights[index];
    light.light.intensity /= strongest;
    light.direction_at_reference = solver_scene.lights[index].direction;
    light.diffuse_product = r.albedo * (r.diffuse * light.light.intensity);
    light.specular_product = r.specular * light.light.intensity;
    light.inverse_distance_at_reference = solver_scene.lights[index].inverse_distance;
  }
  return out;
}

Uncertainties EstimateUncertainty(const Solution& solution, const Observations& observations,
                                  const std::vector<std::size_t>& order,
                                  const SolveOptions& options, const ResidualSplits& splits) {
  const Columns columns{observations.channels, static_cast<int>(solution.scene.lights.size())};
  const Covariance covariance = Invert(solution, observations, columns, options);
  const Carried carried =
      CarryOver(solution, observations, order, columns, covariance, splits.unmodelled.straightened);
  const Parts parts = PartsOf(solution, columns, splits, covariance, carried, options.redundancy);
  Uncertainties out{Unflatten(parts.stat + parts.model, carried.unknown, order.size()),
                    Unflatten(parts.stat, carried.unknown, order.size())};
  for (Uncertainty* uncertainty : {&out.total, &out.stat}) {
    uncertainty->condition = covariance.condition;
    uncertainty->weak = covariance.weak;
    uncertainty->weak.insert(uncertainty->weak.end(), parts.weak.begin(), parts.weak.end());
  }
  return out;
}

}  // namespace turnlight::estimator
