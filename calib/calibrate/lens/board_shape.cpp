#include "calib/calibrate/lens/board_shape.h"

#include <Eigen/SparseCholesky>
#include <cmath>

#include "calib/calibrate/lens/covariance.h"

namespace turnlight::calib::calibrate::lens {
namespace {

constexpr std::size_t kLeastShapeViews = 8, kLeastSeen = 5;
constexpr int kMaxSteps = 30, kOutlierRounds = 3;
constexpr double kEnough = 1e-7;  // relative descent of the cost
// In standard deviations of the noise per axis: mrcal's own lie near 4 and 5.
constexpr double kOutlier = 5.0, kInlier = 3.5;

bool SeenOftenEnough(const Problem& problem) {
  if (problem.poses.size() < kLeastShapeViews ||
      problem.grid.cells.size() != problem.points_per_view())
    return false;
  for (const int cell : problem.grid.cells) {
    std::size_t seen = 0;
    for (std::size_t view = 0; view < problem.poses.size(); ++view)
      if (problem.observed[view * problem.points_per_view() + static_cast<std::size_t>(cell)].z >
          0.0)
        ++seen;
    if (seen < kLeastSeen) return false;
  }
  return true;
}

// By a step of the packed state, in the order of Linearize.
void Move(Problem& problem, const Linearization& linear, const Eigen::VectorXd& packed) {
  const Eigen::VectorXd step = linear.scales.cwiseProduct(packed);
  const auto held = static_cast<Eigen::Index>(problem.intrinsics.size()) - linear.intrinsics_count;
  for (Eigen::Index i = 0; i < linear.intrinsics_count; ++i)
    problem.intrinsics[static_cast<std::size_t>(held + i)] += step[linear.intrinsics_index + i];
  Eigen::Index at = linear.poses_index;
  for (mrcal_pose_t& pose : problem.poses) {
    for (double& value : pose.r.xyz) value += step[at++];
    for (double& value : pose.t.xyz) value += step[at++];
  }
  if (linear.warp_index >= 0)
    for (Eigen::Index i = 0; i < 2; ++i) problem.warp.values[i] += step[linear.warp_index + i];
  at = linear.shape_index;
  for (Eigen::Vector3d& offset : problem.shape) {
    offset += step.segment<3>(at);
    at += 3;
  }
}

bool Descend(Problem& problem, const Pass& pass) {
  Linearization linear = Linearize(problem, pass);
  double cost = linear.residuals.squaredNorm();
  for (int k = 0; k < kMaxSteps; ++k) {
    const Eigen::SparseMatrix<double> jacobian = linear.jacobian;
    const Eigen::SparseMatrix<double> normal = jacobian.transpose() * jacobian;
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(normal);
    if (factor.info() != Eigen::Success) return false;
    const Eigen::VectorXd step = -factor.solve(jacobian.transpose() * linear.residuals);
    if (!step.allFinite()) return false;
    double next_cost = cost;
    Problem next;
    Linearization next_linear;
    for (double length = 1.0; length > 0.05; length *= 0.5) {
      next = problem;
      Move(next, linear, length * step);
      next_linear = Linearize(next, pass);
      next_cost = next_linear.residuals.squaredNorm();
      if (next_cost < cost) break;
    }
    if (!(next_cost < cost)) return true;
    const bool done = next_cost > (1.0 - kEnough) * cost;
    problem = std::move(next);
    linear = std::move(next_linear);
    cost = next_cost;
    if (done) return true;
  }
  return true;
}

// Gives the number of points that changed sides.
std::size_t JudgeOutliers(Problem& problem, double sigma) {
  std::size_t changed = 0;
  const std::size_t points = problem.points_per_view();
  for (std::size_t view = 0; view < problem.poses.size(); ++view) {
    const auto residuals = Residuals(problem, view);
    for (std::size_t i = 0; i < points; ++i) {
      if (residuals[i].hasNaN()) continue;
      double& weight = problem.observed[view * points + i].z;
      const double off = std::abs(weight) * residuals[i].lpNorm<Eigen::Infinity>() / sigma;
      if (weight > 0.0 ? off <= kOutlier : off >= kInlier) continue;
      weight = -weight;
      ++changed;
    }
  }
  return changed;
}

}  // namespace

bool FitShape(Problem& problem, const Pass& pass) {
  if (!SeenOftenEnough(problem)) return false;
  Problem fitted = problem;
  fitted.shape.assign(fitted.points_per_view(), Eigen::Vector3d::Zero());
  for (int round = 0; round < kOutlierRounds; ++round) {
    if (!Descend(fitted, pass)) return false;
    const double sigma = NoiseOf(fitted, Linearize(fitted, pass)).rms_px;
    if (!pass.rejects_outliers || JudgeOutliers(fitted, sigma) == 0) break;
  }
  problem = std::move(fitted);
  return true;
}

}  // namespace turnlight::calib::calibrate::lens
