#include "estimator/solve/frame_factors.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace turnlight::estimator::solve {
namespace {

constexpr double kSeen = 1e-4;   // of the largest information about a light in any keyframe
constexpr double kRidge = 1e-9;  // of a unit diagonal: two lights may look the same in a keyframe

// The inverse of a symmetric matrix in the rows that are used, 0 in the others.
Eigen::MatrixXd InverseOf(const Eigen::MatrixXd& matrix, const std::vector<bool>& used) {
  const Eigen::Index n = matrix.rows();
  Eigen::VectorXd scale = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 0; i < n; ++i)
    if (used[static_cast<std::size_t>(i)] && matrix(i, i) > 0.0)
      scale[i] = 1.0 / std::sqrt(matrix(i, i));
  Eigen::MatrixXd unit = scale.asDiagonal() * matrix * scale.asDiagonal();
  for (Eigen::Index i = 0; i < n; ++i) unit(i, i) = 1.0 + kRidge;
  const Eigen::MatrixXd inverse = unit.ldlt().solve(Eigen::MatrixXd::Identity(n, n));
  return scale.asDiagonal() * inverse * scale.asDiagonal();
}

}  // namespace

Eigen::MatrixXd FrameFactors::Substitution(std::size_t keyframe) const {
  const Eigen::MatrixXd& follow = keyframes[keyframe].by_others;
  Eigen::MatrixXd out(follow.cols() + follow.rows(), follow.cols());
  out << Eigen::MatrixXd::Identity(follow.cols(), follow.cols()), follow;
  return out;
}

int FrameFactors::count() const {
  int sum = 0;
  for (std::size_t l = 0; !keyframes.empty() && l < keyframes.front().seen.size(); ++l) {
    const auto sees = [l](const Keyframe& keyframe) { return keyframe.seen[l]; };
    const auto seen = std::count_if(keyframes.begin(), keyframes.end(), sees);
    sum += std::max(static_cast<int>(seen) - 1, 0);
  }
  return sum;
}

// With A the factors' block of a keyframe, B its rows by the others, g its gradient, a step s of
// the others takes the factors by -A^-1 (g + B s + m), m the multipliers that keep their sums:
// K m = -sum A^-1 (g + B s), K = sum A^-1.
FrameFactors EliminateFactors(const std::vector<NormalEquations>& keyframes, int others) {
  FrameFactors out;
  const Eigen::Index lights = keyframes.front().gradient.size() - others;
  Eigen::VectorXd most = Eigen::VectorXd::Zero(lights);
  for (const NormalEquations& of : keyframes)
    most = most.cwiseMax(of.hessian.diagonal().tail(lights));
  Eigen::MatrixXd k = Eigen::MatrixXd::Zero(lights, lights);
  Eigen::MatrixXd by_others = Eigen::MatrixXd::Zero(lights, others);
  Eigen::VectorXd by_gradient = Eigen::VectorXd::Zero(lights);
  std::vector<bool> seen_at_all(static_cast<std::size_t>(lights), false);
  for (const NormalEquations& of : keyframes) {
    FrameFactors::Keyframe& keyframe = out.keyframes.emplace_back();
    for (Eigen::Index l = 0; l < lights; ++l) {
      const bool seen = most[l] > 0.0 && of.hessian(others + l, others + l) > kSeen * most[l];
      keyframe.seen.push_back(seen);
      if (seen) seen_at_all[static_cast<std::size_t>(l)] = true;
    }
    const Eigen::MatrixXd inverse =
        InverseOf(of.hessian.bottomRightCorner(lights, lights), keyframe.seen);
    keyframe.covariance = inverse;
    keyframe.step = inverse * of.gradient.tail(lights);
    keyframe.by_others = inverse * of.hessian.bottomLeftCorner(lights, others);
    k += inverse;
    by_others += keyframe.by_others;
    by_gradient += keyframe.step;
  }
  const Eigen::MatrixXd k_inverse = InverseOf(k, seen_at_all);
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    FrameFactors::Keyframe& keyframe = out.keyframes[i];
    const Eigen::MatrixXd share = keyframe.covariance * k_inverse;
    keyframe.step = share * by_gradient - keyframe.step;
    keyframe.by_others = share * by_others - keyframe.by_others;
    keyframe.covariance -= share * keyframe.covariance;
    out.gain -= 0.5 * keyframe.step.dot(keyframes[i].gradient.tail(lights));
  }
  return out;
}

void AddReduced(const FrameFactors& factors, std::size_t keyframe, const NormalEquations& equations,
                NormalEquations& sum) {
  const Eigen::MatrixXd all_by_others = factors.Substitution(keyframe);
  if (sum.gradient.size() == 0) {
    sum.hessian = Eigen::MatrixXd::Zero(all_by_others.cols(), all_by_others.cols());
    sum.gradient = Eigen::VectorXd::Zero(all_by_others.cols());
  }
  sum.hessian += all_by_others.transpose() * equations.hessian * all_by_others;
  sum.gradient += all_by_others.transpose() * equations.gradient;
  sum.cost += equations.cost;
}

void CompleteFactors(std::size_t keyframes, model::Scene& scene) {
  for (model::Light& light : scene.lights) light.factors.resize(keyframes, 1.0);
}

void MoveFactors(const FrameFactors& factors, const Eigen::VectorXd& step, double share,
                 model::Scene& scene) {
  for (std::size_t l = 0; l < scene.lights.size(); ++l) {
    model::Light& light = scene.lights[l];
    const auto row = static_cast<Eigen::Index>(l);
    double sum = 0.0;
    int seen = 0;
    for (std::size_t k = 0; k < factors.keyframes.size(); ++k) {
      const FrameFactors::Keyframe& keyframe = factors.keyframes[k];
      if (!keyframe.seen[l]) continue;
      const double by = share * keyframe.step[row] + keyframe.by_others.row(row).dot(step);
      light.factors[k] = std::max(light.factors[k] + by, 0.0);
      sum += light.factors[k];
      ++seen;
    }
    // Not 1 where one ended at 0, or a keyframe sees the light that did not before.
    const double mean = seen > 0 ? sum / seen : 1.0;
    if (!(mean > 0.0)) continue;
    for (std::size_t k = 0; k < factors.keyframes.size(); ++k)
      if (factors.keyframes[k].seen[l]) light.factors[k] /= mean;
    light.intensity *= mean;
  }
}

}  // namespace turnlight::estimator::solve
