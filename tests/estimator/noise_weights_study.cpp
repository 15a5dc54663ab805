// A study: over 40 scenes with strong shot noise, weighing pixels by the sensor's noise lowers the
// errors of the lights' directions, and the stated sigmas stay those of the errors. Scenes have the
// estimator's own model: nothing but noise makes an error.
#include <gtest/gtest.h>

#include <cstdio>

#include "base/statistics.h"
#include "tests/estimator/noise_weights.h"

namespace turnlight::estimator {
namespace {

TEST(NoiseWeightsStudy, FortyScenes) {
  std::vector<double> ratios, pulls_uniform, pulls_weighted;
  double uniform = 0.0, weighted = 0.0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const auto errors = EstimateBothWays(seed);
    ASSERT_TRUE(errors) << seed << ": " << errors.error().text;
    std::printf("seed %2d: %.4f deg uniform (sigma %.4f), %.4f deg weighted (sigma %.4f)\n",
                static_cast<int>(seed), errors->uniform, errors->uniform_sigma, errors->weighted,
                errors->weighted_sigma);
    ratios.push_back(errors->weighted / errors->uniform);
    uniform += std::log(errors->uniform);
    weighted += std::log(errors->weighted);
    pulls_uniform.push_back(errors->uniform / errors->uniform_sigma);
    pulls_weighted.push_back(errors->weighted / errors->weighted_sigma);
  }
  const double geometric = std::exp((weighted - uniform) / 40.0), median = Median(ratios);
  std::printf("weighted over uniform: median %.3f, geometric mean %.3f; error over sigma, median: "
              "%.2f uniform, %.2f weighted\n",
              median, geometric, Median(pulls_uniform), Median(pulls_weighted));
  EXPECT_LT(median, 0.9);
  EXPECT_LT(geometric, 0.9);
}

}  // namespace
}  // namespace turnlight::estimator
