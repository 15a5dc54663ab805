// Proves: a pixel at white counts only where the model is below it, in each channel by itself where
// lights have colours, and in the sum of the channels where they have none. Does not prove that
// estimates from clipped pictures are right: photograph_lights_test, and real photographs.
#include <gtest/gtest.h>

#include "estimator/solve/normal_equations.h"
#include "estimator/solve/prediction.h"
#include "tests/estimator/random_observations.h"
#include "tests/estimator/solve/random_scene.h"

namespace turnlight::estimator::solve {
namespace {

// Under white lights the channels are together: at white, a model whose sum over them is above the
// picture's is no residual.
TEST(OneSided, APixelAtWhiteIsJudgedByItsSumWhereChannelsAreTogether) {
  const model::Scene scene =
      RandomScene(4, model::SpecularModel::kPhong, model::DiffuseModel::kLambert);
  RandomObservations all(700, 3, 8);
  observe::Observations& censored = all.observations;
  censored.one_sided = true;
  censored.at_white.assign(censored.size(), 0);
  const Prediction model = Predict(censored, scene, {});
  observe::Observations left_out = censored;
  std::size_t satisfied = 0;
  for (std::size_t i = 0; i < 700; i += 2) {
    censored.at_white[i] = i % 4 == 0 ? 7 : 2;  // one is enough
    double above = 0.0;
    for (std::size_t c = 0; c < 3; ++c) above += model[c][i] - censored.radiance[c][i];
    if (above <= 0.0) continue;
    left_out.pixel[i] = observe::Observations::kNoPixel;
    ++satisfied;
  }
  ASSERT_GT(satisfied, 50u);
  ASSERT_LT(satisfied, 300u);
  for (const double huber : {0.0, 0.1}) {
    EvaluateOptions options;
    options.huber = huber;
    const NormalEquations a = EvaluateDouble(censored, scene, options),
                          b = EvaluateDouble(left_out, scene, options);
    EXPECT_NEAR(a.cost, b.cost, 1e-9 * b.cost);
    EXPECT_LT((a.gradient - b.gradient).norm(), 1e-9 * b.gradient.norm());
    EXPECT_LT((a.hessian - b.hessian).norm(), 1e-9 * b.hessian.norm());
  }
}

// A pixel at white counts as one that is left out where the model is above it, and as any other
// where it is below; in each channel by itself where lights have colours.
TEST(OneSided, APixelAtWhiteCountsOnlyWhereTheModelIsBelow) {
  model::Scene scene = RandomScene(4, model::SpecularModel::kPhong, model::DiffuseModel::kLambert);
  scene.reflectance.ambient_colour[2] -= 1e-15;  // a colour, of which nothing is seen
  RandomObservations all(700, 3, 8);
  GiveWeights(3, all.observations);
  observe::Observations& censored = all.observations;
  censored.one_sided = true;
  censored.at_white.assign(censored.size(), 0);
  const Prediction model = Predict(censored, scene, {});
  for (const double huber : {0.0, 0.1}) {
    EvaluateOptions options;
    options.huber = huber;
    std::vector<observe::Observations> alone(3, censored);
    for (std::size_t c = 0; c < 3; ++c) {
      alone[c].channels = 1;
      alone[c].one_sided = false;
      alone[c].at_white.clear();
      alone[c].radiance[0] = censored.radiance[c];
      for (std::size_t i = 0; i < 700; ++i) {
        if ((i + c) % 3 != 0) continue;
        censored.at_white[i] |= static_cast<std::uint8_t>(1u << c);
        if (model[c][i] > censored.radiance[c][i])
          alone[c].pixel[i] = observe::Observations::kNoPixel;
      }
    }
    const NormalEquations together = EvaluateDouble(censored, scene, options);
    NormalEquations sum;
    sum.gradient = Eigen::VectorXd::Zero(together.gradient.size() - 3);
    for (int c = 0; c < 3; ++c) {
      model::Scene grey = scene;
      grey.reflectance.albedo.setConstant(scene.reflectance.albedo[c]);
      const NormalEquations one = EvaluateDouble(alone[static_cast<std::size_t>(c)], grey, options);
      sum.cost += one.cost;
      sum.gradient += one.gradient.tail(sum.gradient.size());
      EXPECT_NEAR(together.gradient[c], one.gradient[0], 1e-9 * std::abs(one.gradient[0]) + 1e-12);
    }
    EXPECT_NEAR(together.cost, sum.cost, 1e-9 * sum.cost);
    EXPECT_LT((together.gradient.tail(sum.gradient.size()) - sum.gradient).norm(),
              1e-9 * sum.gradient.norm());
  }
}

}  // namespace
}  // namespace turnlight::estimator::solve
