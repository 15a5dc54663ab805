#include "estimator/solver.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <deque>
#include <memory>
#include <utility>

namespace turnlight::estimator {
namespace {

// One Ceres parameter block: where its values live, and the columns of the normal equations that
// belong to it. A direction has three values and two columns.
struct Block {
  double* values;
  int size;
  int column;
  int light = -1;  // of a direction
};

// The scene as blocks of doubles, in the order in which the cost function sees them.
class BlockedScene {
 public:
  BlockedScene(const Scene& scene, int channels)
      : scene_(scene),
        columns_{channels, static_cast<int>(scene.lights.size())},
        log_shininess_(std::log(scene.reflectance.shininess)),
        roughness_squared_(scene.reflectance.roughness * scene.reflectance.roughness) {
    Reflectance& r = scene_.reflectance;
    for (int c = 0; c < channels; ++c) Add(&r.albedo[c], 1, columns_.Albedo(c));
    Add(&r.ambient, 1, columns_.Ambient());
    Add(&r.diffuse, 1, columns_.Diffuse());
    Add(&r.specular, 1, columns_.Specular());
    Add(&log_shininess_, 1, columns_.LogShininess());
    Add(&roughness_squared_, 1, columns_.RoughnessSquared());
    for (int l = 0; l < columns_.lights; ++l) {
      Light& light = scene_.lights[static_cast<std::size_t>(l)];
      Add(&light.intensity, 1, columns_.Intensity(l));
      Add(light.direction.data(), 3, columns_.Tangent(l));
      blocks_.back().light = l;
      Add(&light.inverse_distance, 1, columns_.InverseDistance(l));
    }
  }
  BlockedScene(const BlockedScene&) = delete;
  BlockedScene& operator=(const BlockedScene&) = delete;

  const std::vector<Block>& blocks() const { return blocks_; }
  const Columns& columns() const { return columns_; }
  // The scene with the blocks' current values.
  Scene Current() const {
    Scene scene = scene_;
    scene.reflectance.shininess = std::exp(log_shininess_);
    scene.reflectance.roughness = std::sqrt(roughness_squared_);
    for (Light& light : scene.lights) light.direction.normalize();
    return scene;
  }
  void CopyFrom(const double* const* values) {
    for (std::size_t i = 0; i < blocks_.size(); ++i)
      std::copy_n(values[i], blocks_[i].size, blocks_[i].values);
  }

 private:
  void Add(double* values, int size, int column) { blocks_.push_back({values, size, column}); }

  Scene scene_;
  Columns columns_;
  double log_shininess_;
  double roughness_squared_;
  std::vector<Block> blocks_;
};

// Cost, gradient and Gauss-Newton matrix of millions of residuals as a handful: with J^T J =
// D V L V^T D, D the column norms, the residual L^(-1/2) V^T D^-1 g and the Jacobian L^(1/2) V^T D
// have the same gradient and matrix; one more constant residual carries what is left of the cost.
struct Compressed {
  Eigen::VectorXd residual;  // columns + 1
  Eigen::MatrixXd jacobian;  // (columns + 1) x columns
};

Compressed Compress(const NormalEquations& equations) {
  const Eigen::Index n = equations.gradient.size();
  Eigen::VectorXd scale = equations.hessian.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Eigen::VectorXd inverse = scale.unaryExpr([](double s) { return s > 0.0 ? 1.0 / s : 0.0; });
  const Eigen::MatrixXd scaled = inverse.asDiagonal() * equations.hessian * inverse.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
  const double floor = 1e-13 * std::max(eigen.eigenvalues().maxCoeff(), 1e-300);
  const Eigen::VectorXd projected =
      eigen.eigenvectors().transpose() * (inverse.asDiagonal() * equations.gradient);
  Compressed out{Eigen::VectorXd::Zero(n + 1), Eigen::MatrixXd::Zero(n + 1, n)};
  for (Eigen::Index i = 0; i < n; ++i) {
    const double value = eigen.eigenvalues()[i];
    if (!(value > floor)) continue;
    out.residual[i] = projected[i] / std::sqrt(value);
    out.jacobian.row(i) =
        std::sqrt(value) * (eigen.eigenvectors().col(i).transpose() * scale.asDiagonal());
  }
  const double rest = 2.0 * equations.cost - out.residual.squaredNorm();
  out.residual[n] = std::sqrt(std::max(rest, 0.0));
  return out;
}

class CompressedCost final : public ceres::CostFunction {
 public:
  CompressedCost(const Observations& observations, const Scene& start,
                 const EvaluateOptions& options)
      : observations_(observations), options_(options), scene_(start, observations.channels) {
    for (const Block& block : scene_.blocks())
      mutable_parameter_block_sizes()->push_back(block.size);
    set_num_residuals(scene_.columns().count() + 1);
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const Point& point = At(parameters);
    if (!point.compressed.residual.allFinite()) return false;
    Eigen::Map<Eigen::VectorXd>(residuals, num_residuals()) = point.compressed.residual;
    if (!jacobians) return true;
    const auto& blocks = scene_.blocks();
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      if (!jacobians[i]) continue;
      using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
      Eigen::Map<RowMajor> out(jacobians[i], num_residuals(), blocks[i].size);
      if (blocks[i].light < 0) {
        out = point.compressed.jacobian.col(blocks[i].column);
      } else {
        const Eigen::Vector3d direction = Eigen::Map<const Eigen::Vector3d>(parameters[i]);
        out = point.compressed.jacobian.middleCols(blocks[i].column, 2) *
              TangentBasis(direction.normalized()).transpose();
      }
    }
    return true;
  }

 private:
  struct Point {
    std::vector<double> key;
    Compressed compressed;
  };

  // Ceres asks for cost and Jacobian of the same point in separate calls; one pass gives both.
  const Point& At(double const* const* parameters) const {
    std::vector<double> key;
    const auto& blocks = scene_.blocks();
    for (std::size_t i = 0; i < blocks.size(); ++i)
      key.insert(key.end(), parameters[i], parameters[i] + blocks[i].size);
    for (const Point& point : recent_)
      if (point.key == key) return point;
    scene_.CopyFrom(parameters);
    const NormalEquations equations =
        estimator::Evaluate(observations_, scene_.Current(), options_);
    if (recent_.size() == 4) recent_.pop_front();
    recent_.push_back({std::move(key), Compress(equations)});
    return recent_.back();
  }

  const Observations& observations_;
  const EvaluateOptions& options_;
  mutable BlockedScene scene_;
  mutable std::deque<Point> recent_;
};

std::size_t Strongest(const std::vector<Light>& lights) {
  const auto weaker = [](const Light& a, const Light& b) { return a.intensity < b.intensity; };
  return static_cast<std::size_t>(std::max_element(lights.begin(), lights.end(), weaker) -
                                  lights.begin());
}

// What the solver may do with one scalar.
struct Limits {
  bool held = false;
  double low = 0.0;
  double high = std::numeric_limits<double>::infinity();
};

std::vector<Limits> LimitsOf(const Columns& columns, const Scene& start,
                             const SolveOptions& options) {
  std::vector<Limits> limits(static_cast<std::size_t>(columns.count()));
  const auto at = [&](int column) -> Limits& { return limits[static_cast<std::size_t>(column)]; };
  int gauge_channel = 0;
  start.reflectance.albedo.head(columns.channels).maxCoeff(&gauge_channel);
  at(columns.Albedo(gauge_channel)).held = true;
  if (options.gauge == Gauge::kDiffuse) at(columns.Diffuse()).held = true;
  const bool specular = start.reflectance.specular_model != SpecularModel::kNone;
  at(columns.Specular()).held = !specular;
  at(columns.LogShininess()) = {!specular, std::log(kMinShininess), std::log(kMaxShininess)};
  const bool rough = start.reflectance.diffuse_model == DiffuseModel::kOrenNayar;
  at(columns.RoughnessSquared()) = {!rough, 0.0, kMaxRoughness * kMaxRoughness};
  for (int l = 0; l < columns.lights; ++l) {
    const auto index = static_cast<std::size_t>(l);
    const bool fixed = !options.fixed_distance.empty() && options.fixed_distance[index];
    at(columns.InverseDistance(l)) = {fixed, 0.0, kMaxInverseDistance};
    const double infinity = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 2; ++k)
      at(columns.Tangent(l) + k) = {!options.free_directions, -infinity, infinity};
    at(columns.Intensity(l)).held =
        options.gauge == Gauge::kStrongestLight && index == Strongest(start.lights);
  }
  return limits;
}

void Apply(ceres::Problem& problem, const BlockedScene& blocked,
           const std::vector<Limits>& limits) {
  for (const Block& block : blocked.blocks()) {
    const Limits& limit = limits[static_cast<std::size_t>(block.column)];
    if (block.light >= 0) problem.SetManifold(block.values, new ceres::SphereManifold<3>());
    if (limit.held) {
      problem.SetParameterBlockConstant(block.values);
      continue;
    }
    if (std::isfinite(limit.low)) problem.SetParameterLowerBound(block.values, 0, limit.low);
    if (std::isfinite(limit.high)) problem.SetParameterUpperBound(block.values, 0, limit.high);
  }
}

// The columns that the data, and not a bound or the gauge, decided.
std::vector<bool> FreeColumns(const BlockedScene& blocked, const std::vector<Limits>& limits) {
  std::vector<bool> free(limits.size());
  for (const Block& block : blocked.blocks()) {
    const auto column = static_cast<std::size_t>(block.column);
    const Limits& limit = limits[column];
    const bool at_bound =
        block.light < 0 && (block.values[0] <= limit.low || block.values[0] >= limit.high);
    free[column] = !limit.held && !at_bound;
    if (block.light >= 0) free[column + 1] = free[column];
  }
  return free;
}

// Ceres wants a start within the bounds.
Scene WithinBounds(Scene scene) {
  Reflectance& r = scene.reflectance;
  r.albedo = r.albedo.cwiseMax(0.0);
  r.ambient = std::max(r.ambient, 0.0);
  r.diffuse = std::max(r.diffuse, 0.0);
  r.specular = std::max(r.specular, 0.0);
  r.shininess = std::clamp(r.shininess, kMinShininess, kMaxShininess);
  r.roughness = std::clamp(r.roughness, 0.0, kMaxRoughness);
  for (Light& light : scene.lights) {
    light.intensity = std::max(light.intensity, 0.0);
    light.inverse_distance = std::clamp(light.inverse_distance, 0.0, kMaxInverseDistance);
  }
  return scene;
}

}  // namespace

Solution Solve(const Observations& observations, const Scene& start, const SolveOptions& options) {
  const Scene begin = WithinBounds(start);
  BlockedScene blocked(begin, observations.channels);
  CompressedCost cost(observations, begin, options.evaluate);
  ceres::Problem::Options problem_options;
  problem_options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(problem_options);
  std::vector<double*> parameters;
  for (const Block& block : blocked.blocks()) parameters.push_back(block.values);
  problem.AddResidualBlock(&cost, nullptr, parameters);
  const std::vector<Limits> limits = LimitsOf(blocked.columns(), begin, options);
  Apply(problem, blocked, limits);

  ceres::Solver::Options solver;
  solver.logging_type = ceres::SILENT;
  solver.num_threads = 1;  // the pass itself is parallel, and its sums are ordered
  solver.linear_solver_type = ceres::DENSE_QR;
  solver.max_num_iterations = options.max_iterations;
  solver.function_tolerance = options.function_tolerance;
  solver.gradient_tolerance = 0.0;
  solver.parameter_tolerance = 1e-10;
  solver.initial_trust_region_radius = 1e3;
  solver.max_solver_time_in_seconds = 1e9;  // no clock may decide a result
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);

  Solution solution;
  solution.scene = blocked.Current();
  solution.equations = Evaluate(observations, solution.scene, options.evaluate);
  for (const auto& iteration : summary.iterations) solution.cost_history.push_back(iteration.cost);
  solution.free = FreeColumns(blocked, limits);
  // None at all if the start cannot even be evaluated.
  solution.iterations = std::max(static_cast<int>(summary.iterations.size()) - 1, 0);
  solution.evaluate = options.evaluate;
  solution.converged = summary.termination_type == ceres::CONVERGENCE;
  return solution;
}

Scene Normalised(const Scene& scene) {
  Scene out = scene;
  Reflectance& r = out.reflectance;
  const double albedo = r.albedo.maxCoeff();
  if (albedo > 0.0) {
    r.albedo /= albedo;
    r.ambient *= albedo;
    r.diffuse *= albedo;
  }
  std::stable_sort(out.lights.begin(), out.lights.end(),
                   [](const Light& a, const Light& b) { return a.intensity > b.intensity; });
  if (!out.lights.empty() && out.lights.front().intensity > 0.0) {
    const double strongest = out.lights.front().intensity;
    for (Light& light : out.lights) light.intensity /= strongest;
    r.diffuse *= strongest;
    r.specular *= strongest;
  }
  return out;
}

}  // namespace turnlight::estimator
