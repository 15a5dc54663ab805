// Proves: the step with factors eliminated is that of the whole system with its constraints, solved
// densely; from random surface points, the solver ends where the cost has no slope by any factor,
// finds factors within their sigmas with the lights where constant lamps would leave them, for
// white and for coloured lights; a keyframe that does not see a light leaves its factor alone.
// Does not prove that factors are called for: select/intensity_rung_test.
#include "estimator/solve/frame_factors.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "base/angles.h"
#include "base/random.h"
#include "estimator/solve/solver.h"
#include "estimator/uncertainty/uncertainty.h"
#include "tests/estimator/changing_lights.h"

namespace turnlight::estimator::solve {
namespace {

constexpr int kOthers = 5, kFactors = 2, kKeyframes = 4;

NormalEquations RandomEquations(std::uint64_t seed) {
  const RandomStream random(seed, 1);
  constexpr int kColumns = kOthers + kFactors;
  Eigen::MatrixXd jacobian(12, kColumns);
  Eigen::VectorXd residual(12);
  std::uint64_t draw = 0;
  for (Eigen::Index row = 0; row < 12; ++row) {
    residual[row] = random.Normal(draw++);
    for (Eigen::Index c = 0; c < kColumns; ++c) jacobian(row, c) = random.Normal(draw++);
  }
  NormalEquations out;
  out.hessian = jacobian.transpose() * jacobian;
  out.gradient = jacobian.transpose() * residual;
  out.cost = 0.5 * residual.squaredNorm();
  return out;
}

// The whole system: others, factors of each keyframe, multipliers of their sums.
Eigen::VectorXd DenseStep(const std::vector<NormalEquations>& keyframes) {
  constexpr int kAll = kOthers + kFactors * kKeyframes + kFactors;
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(kAll, kAll);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(kAll);
  for (int k = 0; k < kKeyframes; ++k) {
    const NormalEquations& of = keyframes[static_cast<std::size_t>(k)];
    const int at = kOthers + kFactors * k;
    matrix.topLeftCorner(kOthers, kOthers) += of.hessian.topLeftCorner(kOthers, kOthers);
    matrix.block(0, at, kOthers, kFactors) = of.hessian.topRightCorner(kOthers, kFactors);
    matrix.block(at, 0, kFactors, kOthers) = of.hessian.bottomLeftCorner(kFactors, kOthers);
    matrix.block(at, at, kFactors, kFactors) = of.hessian.bottomRightCorner(kFactors, kFactors);
    for (int l = 0; l < kFactors; ++l)
      matrix(at + l, kAll - kFactors + l) = matrix(kAll - kFactors + l, at + l) = 1.0;
    right.head(kOthers) -= of.gradient.head(kOthers);
    right.segment(at, kFactors) = -of.gradient.tail(kFactors);
  }
  return matrix.partialPivLu().solve(right);
}

TEST(FrameFactors, TheReducedStepIsThatOfTheWholeSystem) {
  std::vector<NormalEquations> keyframes;
  for (int k = 0; k < kKeyframes; ++k)
    keyframes.push_back(RandomEquations(static_cast<std::uint64_t>(k) + 1));
  const FrameFactors factors = EliminateFactors(keyframes, kOthers);
  NormalEquations sum;
  for (std::size_t k = 0; k < keyframes.size(); ++k) AddReduced(factors, k, keyframes[k], sum);
  const Eigen::VectorXd dense = DenseStep(keyframes);
  const Eigen::VectorXd step = -sum.hessian.partialPivLu().solve(sum.gradient);
  EXPECT_LT((step - dense.head(kOthers)).norm(), 1e-6 * step.norm());
  double gained = factors.gain - step.dot(sum.gradient + 0.5 * sum.hessian * step), direct = 0.0;
  for (int k = 0; k < kKeyframes; ++k) {
    const FrameFactors::Keyframe& of = factors.keyframes[static_cast<std::size_t>(k)];
    const Eigen::VectorXd moved = of.step + of.by_others * step;
    EXPECT_LT((moved - dense.segment(kOthers + kFactors * k, kFactors)).norm(), 1e-6) << k;
    Eigen::VectorXd all(kOthers + kFactors);
    all << step, moved;
    const NormalEquations& equations = keyframes[static_cast<std::size_t>(k)];
    direct -= all.dot(equations.gradient + 0.5 * equations.hessian * all);
  }
  EXPECT_NEAR(gained, direct, 1e-6 * direct);
  EXPECT_EQ(factors.count(), (kKeyframes - 1) * kFactors);
}

TEST(FrameFactors, AKeyframeThatDoesNotSeeALightLeavesItsFactorAlone) {
  std::vector<NormalEquations> keyframes;
  for (int k = 0; k < kKeyframes; ++k)
    keyframes.push_back(RandomEquations(static_cast<std::uint64_t>(k) + 1));
  NormalEquations& blind = keyframes[2];
  blind.hessian.row(kOthers).setZero();
  blind.hessian.col(kOthers).setZero();
  blind.gradient[kOthers] = 0.0;
  const FrameFactors factors = EliminateFactors(keyframes, kOthers);
  EXPECT_FALSE(factors.keyframes[2].seen[0]);
  EXPECT_EQ(factors.keyframes[2].step[0], 0.0);
  EXPECT_TRUE(factors.keyframes[2].by_others.row(0).isZero(0.0));
  model::Scene scene;
  scene.lights.resize(kFactors);
  CompleteFactors(kKeyframes, scene);
  scene.lights[0].factors[2] = 1.7;
  MoveFactors(factors, Eigen::VectorXd::Zero(kOthers), 1.0, scene);
  EXPECT_EQ(scene.lights[0].factors[2], 1.7);
}

Solution SolveChanging(const observe::Observations& all, const model::Scene& truth) {
  model::Scene start = model::WithoutFactors(truth);
  start.free_factors = true;
  for (model::Light& light : start.lights) light.direction = Turned(light.direction, 2.0);
  return Solve(all, start, {});
}

TEST(FrameFactors, TheCostHasNoSlopeWhereTheSolverEnds) {
  const model::Scene truth = Changing(TwoLights(), 0.05, 12, 4);
  const observe::Observations all = ChangingPictures(truth, 12, 0.004);
  const Solution solution = SolveChanging(all, truth);
  model::Scene fixed = solution.scene;
  fixed.free_factors = false;
  const double cost = EvaluateDouble(all, fixed, {}).cost;
  EXPECT_NEAR(cost, solution.equations.cost, 1e-5 * cost);
  for (std::size_t l = 0; l < 2; ++l)
    for (std::size_t k = 0; k + 1 < 12; ++k) {
      const auto moved = [&](double by) {
        model::Scene scene = fixed;
        scene.lights[l].factors[k] += by;
        scene.lights[l].factors[k + 1] -= by;
        return EvaluateDouble(all, scene, {}).cost;
      };
      constexpr double kStep = 1e-4;
      const double up = moved(kStep), down = moved(-kStep);
      const double lowest = 0.5 * kStep * (down - up) / (up + down - 2.0 * cost);
      EXPECT_LT(std::abs(lowest), 2e-5) << l << " " << k;
    }
}

TEST(FrameFactors, AreFoundWithinTheirSigmas) {
  for (const bool coloured : {false, true}) {
    model::Scene truth = TwoLights();
    if (coloured) truth.lights[1].color = {1.0, 0.8, 0.6};
    truth = Changing(truth, 0.05, 20, 9);
    const observe::Observations all = ChangingPictures(truth, 20, 0.004);
    model::Scene named = truth;
    named.free_colours = coloured;
    const Solution solution = SolveChanging(all, named);
    const auto order = uncertainty::StrengthOrder(solution.scene, all);
    const uncertainty::Uncertainties sigmas = uncertainty::EstimateUncertainty(
        solution, all, order, 1.0, uncertainty::SplitResiduals(all, solution));
    int within = 0, within_three = 0, values = 0;
    for (std::size_t i = 0; i < order.size(); ++i) {
      const model::Light& light = solution.scene.lights[order[i]];
      double mean = 0.0;
      for (std::size_t k = 0; k < 20; ++k) {
        const double off = std::abs(light.factors[k] - truth.lights[order[i]].factors[k]);
        mean += light.factors[k] / 20.0;
        within += off < sigmas.factors[i][k] ? 1 : 0;
        within_three += off < 3.0 * sigmas.factors[i][k] ? 1 : 0;
        ++values;
      }
      EXPECT_NEAR(mean, 1.0, 1e-9);
      EXPECT_LT(AngleDeg(light.direction, truth.lights[order[i]].direction),
                3.0 * RadToDeg(sigmas.total.lights[i].direction));
      EXPECT_LT(sigmas.total.lights[i].direction, DegToRad(0.2));
    }
    EXPECT_GE(within_three, values - 1);
    EXPECT_GE(within, values / 2);
    EXPECT_LE(within, values * 9 / 10);
  }
}

}  // namespace
}  // namespace turnlight::estimator::solve
