// Proves the excess variance in closed form: what is above the noise, never below a floor that
// grows with it, and when nothing is left to explain. Does not prove that the floor is the right
// one: bench/studies does.
#include "estimator/start/sample.h"

#include <gtest/gtest.h>

#include "tests/estimator/start/noisy_sample.h"

namespace turnlight::estimator::start {
namespace {

TEST(ExcessVariance, IsWhatIsAboveTheNoise) {
  EXPECT_EQ(ExcessVariance(0.0, 0.0), 2.5e-7) << "(5e-4)^2";
  EXPECT_DOUBLE_EQ(ExcessVariance(1e-4, 0.0), 1e-4 + 2.5e-7);
  EXPECT_DOUBLE_EQ(ExcessVariance(5e-4, 0.02), 1e-4 + 2.5e-7 + 0.005 * 4e-4);
  // A residual below the noise is no virtue.
  EXPECT_EQ(ExcessVariance(1e-4, 0.02), ExcessVariance(4e-4, 0.02));
}

TEST(NothingLeft, AtTheFloorAndNotAboveChance) {
  Sample sample = NoisySample(TwoLights());
  EXPECT_EQ(ValuesIn(sample.pixels), 12000.0);
  for (const double noise : {0.0, 0.003, 0.05}) {
    sample.noise = noise;
    const double floor = ExcessVariance(0.0, noise);
    EXPECT_TRUE(NothingLeft(floor, sample));
    // The variance of 12000 values is known to 1.3 %; four sigma of that.
    const double chance = 4.0 * noise * noise * std::sqrt(2.0 / 12000.0);
    EXPECT_TRUE(NothingLeft(1.49 * floor + chance, sample));
    EXPECT_FALSE(NothingLeft(1.51 * floor + chance, sample));
  }
}

}  // namespace
}  // namespace turnlight::estimator::start
