// Proves: bfloat16 is the nearest number of eight bits of precision, ties to even, with a float's
// range and zeros of both signs. Does not prove anything of infinities and NaN, which footprints
// never are.
#include "estimator/observe/bfloat16.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"

namespace turnlight::estimator::observe {
namespace {

float RoundTrip(float value) { return FromBFloat16(ToBFloat16(value)); }

TEST(BFloat16, HoldsWhatHasEightBits) {
  for (const float value : {0.0f, 1.0f, -1.0f, 0.0078125f, 255.0f, -1.9921875f})
    EXPECT_EQ(RoundTrip(value), value);
  EXPECT_TRUE(std::signbit(RoundTrip(-0.0f)));
}

TEST(BFloat16, RoundsToTheNearestAndTiesToEven) {
  constexpr float kStep = 0.0078125f;  // between neighbours in [1, 2)
  EXPECT_EQ(RoundTrip(1.0f + 0.49f * kStep), 1.0f);
  EXPECT_EQ(RoundTrip(1.0f + 0.51f * kStep), 1.0f + kStep);
  EXPECT_EQ(RoundTrip(1.0f + 0.5f * kStep), 1.0f);
  EXPECT_EQ(RoundTrip(1.0f + 1.5f * kStep), 1.0f + 2.0f * kStep);
  EXPECT_EQ(RoundTrip(-1.0f - 1.5f * kStep), -1.0f - 2.0f * kStep);
  // The carry goes into the exponent.
  EXPECT_EQ(RoundTrip(std::nextafter(2.0f, 0.0f)), 2.0f);
}

TEST(BFloat16, IsWithinAPartIn256OverTheWholeRange) {
  const RandomStream random(1, 1);
  for (std::uint64_t i = 0; i < 10000; ++i) {
    const auto value = static_cast<float>(std::exp2(random.Uniform(2 * i, -120.0, 127.0)) *
                                          (random.Uniform(2 * i + 1) < 0.5 ? -1.0 : 1.0));
    EXPECT_LE(std::abs(RoundTrip(value) / value - 1.0f), 1.0f / 256.0f) << value;
  }
}

}  // namespace
}  // namespace turnlight::estimator::observe
