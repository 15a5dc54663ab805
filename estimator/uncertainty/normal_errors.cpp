#include "estimator/uncertainty/normal_errors.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "estimator/observe/observation_access.h"
#include "estimator/solve/prediction.h"
#include "estimator/solve/unit_diagonal.h"

namespace turnlight::estimator::uncertainty {
namespace {

constexpr double kStep = 1e-3;  // radians
constexpr double kScatterSigmas = 4.0;
constexpr double kOutlying = 16.0;  // squared residual over what is expected of it
constexpr int kRounds = 4;
constexpr double kLeastFallByTilt = 0.2;  // of the cost
constexpr int kTiltRounds = 6;
constexpr double kLeastGainPerRound = 0.01;  // of the cost
constexpr double kMostTurn = 0.1;            // radians in a round
constexpr double kDamping = 1e-3;
constexpr int kSolveIterations = 20;

// Normals and mirrored directions as if the target's normals were turned by a rotation vector.
observe::Observations Tilted(const observe::Observations& all, const Eigen::Vector3d& by) {
  observe::Observations out = all;
  const double angle = by.norm();
  if (angle == 0.0) return out;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(angle, by / angle).toRotationMatrix();
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all.pixel[i] == observe::Observations::kNoPixel) continue;
    const Eigen::Vector3d n = observe::At(all.normal, i), w = observe::At(all.mirrored, i);
    Eigen::Matrix3d in_W = turn;
    if (all.caster != nullptr) {
      const Eigen::Matrix3d& R_TW = all.X_TW[all.keyframe[i]].rotation;
      in_W = R_TW.transpose() * turn * R_TW;
    }
    // A mean normal is a little shorter than one; the view is mirrored about its direction.
    const Eigen::Vector3d unit = n.normalized();
    const Eigen::Vector3d viewer = 2.0 * unit.dot(w) * unit - w;
    const Eigen::Vector3d turned = in_W * n, turned_unit = in_W * unit;
    const Eigen::Vector3d mirrored = 2.0 * turned_unit.dot(viewer) * turned_unit - viewer;
    observe::Put(turned, i, out.normal);
    observe::Put(mirrored, i, out.mirrored);
  }
  return out;
}

// The turn that lowers the cost the most, to first order, when the scene's free columns follow; and
// by how much it does.
struct Turn {
  Eigen::Vector3d by = Eigen::Vector3d::Zero();
  double gain = 0.0;
};

Turn BestTurn(const solve::NormalEquations& at, const std::vector<int>& free,
              const TiltResponse& tilts) {
  Eigen::MatrixXd hessian = at.hessian(free, free);
  const Eigen::VectorXd scale = solve::UnitDiagonalScale(hessian.diagonal());
  hessian = scale.asDiagonal() * hessian * scale.asDiagonal();
  hessian.diagonal().array() += 1e-12;  // what the data do not determine does not follow
  Eigen::MatrixXd cross_hessian(static_cast<Eigen::Index>(free.size()), 3);
  Eigen::Vector3d slope;
  for (int k = 0; k < 3; ++k) {
    const Score& score = tilts.scores[static_cast<std::size_t>(k)];
    cross_hessian.col(k) = scale.asDiagonal() * Eigen::VectorXd(score.cross_hessian(free));
    slope[k] = score.slope;
  }
  const Eigen::LDLT<Eigen::MatrixXd> factors(hessian);
  const Eigen::MatrixXd regression = factors.solve(cross_hessian);
  slope -= regression.transpose() * (scale.asDiagonal() * Eigen::VectorXd(at.gradient(free)));
  // A little of what the tilts do by themselves, for what cannot be told from other lights.
  Eigen::Matrix3d curvature = tilts.information - cross_hessian.transpose() * regression;
  curvature.diagonal() += kDamping * tilts.information.diagonal();
  const Eigen::LDLT<Eigen::Matrix3d> tilt_factors(curvature);
  if (!tilt_factors.isPositive()) return {};
  const Eigen::Vector3d by = -tilt_factors.solve(slope);
  if (!by.allFinite()) return {};
  return {by, -0.5 * slope.dot(by)};
}

}  // namespace

TiltResponse TiltNormals(const observe::Observations& pixels, const model::Scene& scene,
                         const solve::EvaluateOptions& options, const ScoreProbe& probe) {
  TiltResponse out;
  out.by_any.assign(pixels.size(), 0.0);
  std::array<solve::Prediction, 3> slopes;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d by = kStep * Eigen::Vector3d::Unit(axis);
    solve::Prediction slope = solve::Predict(Tilted(pixels, by), scene, options);
    AddTimes(-1.0, solve::Predict(Tilted(pixels, -by), scene, options), slope);
    for (auto& channel : slope)
      for (float& value : channel) value *= static_cast<float>(0.5 / kStep);
    out.scores[static_cast<std::size_t>(axis)] = probe.Of(slope, 1.0);
    slopes[static_cast<std::size_t>(axis)] = std::move(slope);
  }
  out.information.setZero();
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (pixels.pixel[i] == observe::Observations::kNoPixel || pixels.IsAtWhite(i)) continue;
    for (std::size_t c = 0; c < slopes[0].size(); ++c) {
      const Eigen::Vector3d by(static_cast<double>(slopes[0][c][i]),
                               static_cast<double>(slopes[1][c][i]),
                               static_cast<double>(slopes[2][c][i]));
      const double weight = pixels.WeightOf(i);
      out.information += weight * weight * by * by.transpose();
      out.by_any[i] += by.squaredNorm();
    }
  }
  return out;
}

std::optional<model::Scene> FitTilts(const observe::Observations& pixels,
                                     const solve::Solution& solution,
                                     const solve::EvaluateOptions& options,
                                     const solve::NormalEquations& untilted,
                                     const TiltResponse& response) {
  const model::Parameters parameters(solution.scene, pixels.channels);
  std::vector<int> free;
  for (int column = 0; column < parameters.count(); ++column)
    if (!solution.held[static_cast<std::size_t>(column)]) free.push_back(column);
  // A robust loss hides what a large tilt leaves.
  const bool asked = options.huber > 0.0 ||
                     BestTurn(untilted, free, response).gain > kLeastGainPerRound * untilted.cost;
  if (!asked) return std::nullopt;
  solve::SolveOptions solve;
  solve.max_iterations = kSolveIterations;
  solve.evaluate = options;
  solve.evaluate.huber = 0.0;  // what a tilt leaves is no outlier
  solve.evaluate.gradient_only = false;
  for (int l = 0; l < parameters.lights(); ++l)
    solve.fixed_distance.push_back(
        solution.held[static_cast<std::size_t>(parameters.InverseDistance(l))]);
  observe::Observations turned = pixels;
  solve::Solution fit = solve::Solve(pixels, solution.scene, solve);
  const double before = fit.equations.cost;
  for (int round = 0; round < kTiltRounds; ++round) {
    const Turn turn = BestTurn(fit.equations, free,
                               TiltNormals(turned, fit.scene, solve.evaluate,
                                           ScoreProbe(turned, fit.scene, solve.evaluate)));
    const double angle = turn.by.norm();
    if (!(turn.gain > kLeastGainPerRound * before) || !(angle > 0.0)) break;
    const observe::Observations next = Tilted(turned, turn.by * std::min(1.0, kMostTurn / angle));
    solve::Solution better = solve::Solve(next, fit.scene, solve);
    if (!(better.equations.cost < fit.equations.cost)) break;
    turned = next;
    fit = std::move(better);
  }
  if (!(fit.equations.cost < (1.0 - kLeastFallByTilt) * before)) return std::nullopt;
  return fit.scene;
}

double NormalVariance(const observe::Observations& pixels, const solve::Prediction& model,
                      const std::vector<double>& by_any_tilt) {
  std::vector<Eigen::Vector4d> features;
  std::vector<double> squares;
  double mean = 0.0;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (pixels.pixel[i] == observe::Observations::kNoPixel || pixels.IsAtWhite(i)) continue;
    double square = 0.0, grey = 0.0;
    for (std::size_t c = 0; c < model.size(); ++c) {
      const double r =
          static_cast<double>(model[c][i]) - static_cast<double>(pixels.radiance[c][i]);
      square += r * r;
      grey += static_cast<double>(model[c][i]);
    }
    squares.push_back(square);
    features.emplace_back(1.0, grey, grey * grey, by_any_tilt[i]);
    mean += square;
  }
  mean /= std::max(static_cast<double>(squares.size()), 1.0);
  if (!(mean > 0.0)) return 0.0;
  Eigen::Vector4d best(mean, 0.0, 0.0, 0.0);
  double variance = 0.0;
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    Eigen::Vector4d right = Eigen::Vector4d::Zero();
    double sum = 0.0, count = 0.0;
    for (std::size_t i = 0; i < squares.size(); ++i) {
      const double expected = std::max(best.dot(features[i]), 1e-3 * mean);
      if (round > 0 && squares[i] > kOutlying * expected) continue;
      const Eigen::Vector4d f = features[i] / expected;
      const double y = squares[i] / expected;
      normal += f * f.transpose();
      right += y * f;
      sum += (y - 1.0) * (y - 1.0);
      count += 1.0;
    }
    const Eigen::Vector4d scale = solve::UnitDiagonalScale(normal.diagonal());
    const Eigen::LDLT<Eigen::Matrix4d> factors(scale.asDiagonal() * normal * scale.asDiagonal());
    best = scale.asDiagonal() * factors.solve(scale.asDiagonal() * right);
    const Eigen::Vector4d unit = Eigen::Vector4d::Unit(3) * scale[3];
    variance = scale[3] * factors.solve(unit)[3] * sum / std::max(count, 1.0);
  }
  if (!best.allFinite() || !(best[3] > kScatterSigmas * std::sqrt(variance))) return 0.0;
  return best[3];
}

}  // namespace turnlight::estimator::uncertainty
