#include "estimator/baseline/paper_method.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/angles.h"
#include "base/messages/messages.h"
#include "estimator/observe/radiance_statistics.h"
#include "estimator/solve/normal_equations.h"
#include "estimator/solve/solver.h"

namespace turnlight::estimator::baseline {
namespace {

// What the paper does not state; docs/paper_method.md, "What is open".
constexpr double kFirstStep = 1.0;
constexpr double kArmijo = 1e-4;  // share of the linear model's decrease that a step must reach
constexpr int kMaxHalvings = 40;

constexpr double kMaxPaperShininess = 128.0;
// The ranges begin at 0, where the model's derivatives by n / 128 and d do not exist.
constexpr double kLeastShininess = 1e-3 / kMaxPaperShininess;

// The map where zenith angles are at most 90 degrees.
observe::IntensityMap UpperHalf(const observe::IntensityMap& map, const Eigen::Vector3d& up) {
  observe::IntensityMap half{map.intensity.clone()};
  for (int row = 0; row < half.intensity.rows; ++row)
    for (int column = 0; column < half.intensity.cols; ++column)
      if (observe::MapDirection(row, column).dot(up) < 0.0)
        half.intensity(row, column) = std::numeric_limits<float>::quiet_NaN();
  return half;
}

// One iteration's line search: a point of the projected gradient path that lowers the cost enough,
// with its cost and gradient. step is the first trial's on the way in, the accepted one's on the
// way out. False if there is none.
bool Search(const PaperProblem& problem, Eigen::VectorXd& variables, double& cost,
            Eigen::VectorXd& gradient, double& step) {
  for (int halving = 0; halving < kMaxHalvings; ++halving, step *= 0.5) {
    const Eigen::VectorXd trial = problem.Projected(variables - step * gradient);
    const double squared = (trial - variables).squaredNorm();
    if (!(squared > 0.0)) return false;
    Eigen::VectorXd trial_gradient;
    const double trial_cost = problem.Cost(trial, &trial_gradient);
    if (!(trial_cost <= cost - kArmijo / step * squared)) continue;  // NaN is refused as well
    // A decrease below the resolution of the cost is none: the descent has arrived.
    if (!(trial_cost < cost)) return false;
    variables = trial;
    cost = trial_cost;
    gradient = trial_gradient;
    return true;
  }
  return false;
}

}  // namespace

Eigen::Vector3d PaperUp(const std::vector<calib::RigPoses>& poses,
                        const target::Geometry& geometry) {
  if (!std::holds_alternative<calib::PlaneShape>(geometry.shape())) return Eigen::Vector3d::UnitZ();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const calib::RigPoses& pose : poses) sum += pose.X_WT.rotation.col(2);
  // Normals all around cancel out; then W's axis, around which they turn, is as good as any.
  constexpr double kLeastShare = 1e-6;
  return sum.norm() > kLeastShare * static_cast<double>(poses.size())
             ? Eigen::Vector3d(sum.normalized())
             : Eigen::Vector3d(Eigen::Vector3d::UnitZ());
}

std::vector<PaperCluster> ClustersOf(const std::vector<observe::MapPoint>& points, double radius) {
  std::vector<PaperCluster> clusters;
  for (const observe::MapPoint& leader : observe::LeaderClustering(points, radius))
    clusters.push_back({leader.direction, Eigen::Vector3d::Zero(), 0});
  // The first leader within reach among all is the first among those that were there when the point
  // came: leaders are in the order in which they were founded.
  const double cosine = std::cos(radius);
  for (const observe::MapPoint& point : points) {
    const auto joined = std::find_if(clusters.begin(), clusters.end(), [&](const auto& cluster) {
      return cluster.leader == point.direction || cluster.leader.dot(point.direction) >= cosine;
    });
    joined->centroid += point.direction;
    ++joined->cells;
  }
  for (PaperCluster& cluster : clusters) cluster.centroid.normalize();
  return clusters;
}

std::vector<PaperCluster> PaperClusters(const observe::IntensityMap& map,
                                        const Eigen::Vector3d& up) {
  return ClustersOf(observe::HighIntensityArea(UpperHalf(map, up), observe::kHighShare),
                    DegToRad(observe::kClusterRadiusDeg));
}

PaperProblem::PaperProblem(const observe::Observations& observations,
                           std::vector<Eigen::Vector3d> directions, double ceiling_distance)
    : observations_(observations),
      directions_(std::move(directions)),
      radius_(observations.radius / ceiling_distance),
      nearest_distance_(radius_ / model::kMaxInverseDistance) {}

Eigen::VectorXd PaperProblem::Start() const {
  Eigen::VectorXd start = Eigen::VectorXd::Constant(count(), 0.5);
  const Eigen::Vector3d colour = observe::MedianColour(observations_);
  for (int c = 0; c < observations_.channels; ++c) start[Colour(c)] = colour[c];
  start.tail(static_cast<Eigen::Index>(directions_.size())).setOnes();
  return Projected(start);
}

Eigen::VectorXd PaperProblem::Projected(const Eigen::VectorXd& variables) const {
  Eigen::VectorXd out = variables;
  const Eigen::Index lights = static_cast<Eigen::Index>(directions_.size());
  const Eigen::Index bounded = count() - lights;
  out.head(bounded) = out.head(bounded).cwiseMax(0.0).cwiseMin(1.0);
  out[Shininess()] = std::max(out[Shininess()], kLeastShininess);
  out.tail(lights) = out.tail(lights).cwiseMax(nearest_distance_);
  return out;
}

model::Scene PaperProblem::ToScene(const Eigen::VectorXd& variables) const {
  model::Scene scene;
  for (std::size_t l = 0; l < directions_.size(); ++l) {
    const double distance = variables[Distance(static_cast<int>(l))];
    model::Light& light = scene.lights.emplace_back();
    light.direction = directions_[l];
    light.inverse_distance = radius_ / distance;
    light.intensity = 1.0 / (distance * distance);
  }
  model::Reflectance& r = scene.reflectance;
  for (int c = 0; c < 3; ++c) r.albedo[c] = variables[Colour(c < observations_.channels ? c : 0)];
  r.ambient = variables[Ambient()];
  r.diffuse = variables[Diffuse()];
  r.lobes[0].strength = variables[Specular()];
  r.lobes[0].shape = kMaxPaperShininess * variables[Shininess()];
  return scene;
}

double PaperProblem::Cost(const Eigen::VectorXd& variables, Eigen::VectorXd* gradient) const {
  const model::Scene scene = ToScene(variables);
  solve::EvaluateOptions gradient_only;
  gradient_only.gradient_only = true;
  const solve::NormalEquations sums = solve::Evaluate(observations_, scene, gradient_only);
  // The kernel's cost is half the sum of squares.
  const double scale = 2.0 / (static_cast<double>(observations_.used) * observations_.channels);
  if (!gradient) return scale * sums.cost;
  const model::Parameters parameters(scene, observations_.channels);
  gradient->resize(count());
  gradient->head(Shininess()) = sums.gradient.head(Shininess());
  (*gradient)[Shininess()] = sums.gradient[parameters.Shape(0)] / variables[Shininess()];
  for (int l = 0; l < parameters.lights(); ++l) {
    // I = s^-2 and rho = (R / d0) s^-1, s = d / d0.
    const double s = variables[Distance(l)];
    (*gradient)[Distance(l)] = -2.0 / (s * s * s) * sums.gradient[parameters.Intensity(l)] -
                               radius_ / (s * s) * sums.gradient[parameters.InverseDistance(l)];
  }
  *gradient *= scale;
  return scale * sums.cost;
}

PaperDescent Descend(const PaperProblem& problem, const Eigen::VectorXd& start, int max_iterations,
                     const StopFlag* stop) {
  PaperDescent out;
  out.variables = problem.Projected(start);
  Eigen::VectorXd gradient;
  double cost = problem.Cost(out.variables, &gradient);
  out.cost_history.push_back(cost);
  double step = kFirstStep;
  while (out.iterations < max_iterations && !StopRequested(stop)) {
    if (!Search(problem, out.variables, cost, gradient, step)) {
      out.converged = true;
      break;
    }
    ++out.iterations;
    out.cost_history.push_back(cost);
    step *= 2.0;  // backtracking alone could never lengthen it again
  }
  return out;
}

Result<PaperSolution> SolveByPaper(const observe::Observations& observations,
                                   const observe::IntensityMap& map, const PaperOptions& options,
                                   const StopFlag* stop) {
  PaperSolution out;
  out.clusters = PaperClusters(map, options.up);
  if (out.clusters.empty()) return messages::Refuse("paper-no-light");
  std::vector<Eigen::Vector3d> directions;
  for (const PaperCluster& cluster : out.clusters) directions.push_back(cluster.centroid);
  const PaperProblem problem(observations, directions, options.ceiling_distance);
  out.descent = Descend(problem, problem.Start(), options.max_iterations, stop);
  out.scene = problem.ToScene(out.descent.variables);
  return out;
}

}  // namespace turnlight::estimator::baseline
