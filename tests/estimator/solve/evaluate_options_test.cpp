// Proves: a cost is a sum over the values of the pixels that are used, and over those alone. Does
// not prove the cost itself (normal_equations_test).
#include "estimator/solve/evaluate_options.h"

#include <gtest/gtest.h>

#include "estimator/solve/normal_equations.h"
#include "tests/estimator/random_observations.h"

namespace turnlight::estimator::solve {
namespace {

// A model that is 0.1 off everywhere: the mean of squares over the values is 0.01.
TEST(ValueCount, IsWhatTheCostIsASumOver) {
  for (const int channels : {1, 3}) {
    RandomObservations random(1000, channels, 1);
    for (int c = 0; c < channels; ++c)
      random.observations.radiance[c].assign(random.observations.size(), 0.6f);
    model::Scene scene;
    scene.reflectance.ambient = 0.5;
    EvaluateOptions options;
    EXPECT_EQ(ValueCount(random.observations, options), 1000.0 * channels);
    auto usable = std::make_shared<std::vector<std::uint8_t>>(random.observations.size(), 1);
    for (std::size_t i = 0; i < 300; ++i) (*usable)[3 * i] = 0;
    for (const bool some : {false, true}) {
      if (some) {
        options.shadows.usable = usable;
        options.shadows.left_out = 300;
        EXPECT_EQ(ValueCount(random.observations, options), 700.0 * channels);
      }
      const double cost = Evaluate(random.observations, scene, options).cost;
      EXPECT_NEAR(2.0 * cost / ValueCount(random.observations, options), 0.01, 1e-8);
    }
  }
}

}  // namespace
}  // namespace turnlight::estimator::solve
