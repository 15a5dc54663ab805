// Proves: the generator is the published Philox4x32-10; streams are pure functions of their
// address; uniform and normal numbers have the moments they should. Does not prove: statistical
// quality beyond moments (published with the generator).
#include "base/random.h"

#include <gtest/gtest.h>

namespace turnlight {
namespace {

using Words4 = std::array<std::uint32_t, 4>;

// The known answers of Random123's kat_vectors.
TEST(Random, PhiloxKnownAnswers) {
  EXPECT_EQ(Philox4x32({0, 0, 0, 0}, {0, 0}),
            (Words4{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  EXPECT_EQ(Philox4x32({0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}, {0xffffffff, 0xffffffff}),
            (Words4{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(Philox4x32({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (Words4{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(Random, AddressedByIndex) {
  const RandomStream a(1, 2), same(1, 2), other_seed(2, 2), other_stream(1, 3);
  const double later = a.Uniform(1000000007);
  EXPECT_EQ(a.Uniform(5), same.Uniform(5));
  EXPECT_EQ(later, same.Uniform(1000000007));
  EXPECT_NE(a.Uniform(5), a.Uniform(6));
  EXPECT_NE(a.Uniform(5), other_seed.Uniform(5));
  EXPECT_NE(a.Uniform(5), other_stream.Uniform(5));
  EXPECT_NE(RandomStream(std::uint64_t{1} << 40, 0).Uniform(0), RandomStream(0, 0).Uniform(0));
  EXPECT_NE(a.Uniform(std::uint64_t{1} << 40), a.Uniform(0));
}

TEST(Random, UniformMoments) {
  const RandomStream random(3, 4);
  constexpr int kCount = 200000;
  double sum = 0.0, squares = 0.0;
  for (std::uint64_t i = 0; i < kCount; ++i) {
    const double u = random.Uniform(i);
    ASSERT_GT(u, 0.0);
    ASSERT_LT(u, 1.0);
    sum += u;
    squares += u * u;
  }
  // Five standard errors.
  EXPECT_NEAR(sum / kCount, 0.5, 5 * std::sqrt(1.0 / 12 / kCount));
  EXPECT_NEAR(squares / kCount, 1.0 / 3, 5 * std::sqrt(4.0 / 45 / kCount));
  EXPECT_GE(random.Uniform(0, -3.0, -2.0), -3.0);
  EXPECT_LE(random.Uniform(0, -3.0, -2.0), -2.0);
}

TEST(Random, NormalMoments) {
  const RandomStream random(5, 6);
  constexpr int kCount = 400000;
  std::array<double, 5> moment{};
  double neighbours = 0.0, previous = 0.0;
  for (std::uint64_t i = 0; i < kCount; ++i) {
    const double x = random.Normal(i);
    ASSERT_TRUE(std::isfinite(x));
    double power = 1.0;
    for (double& m : moment) {
      m += power / kCount;
      power *= x;
    }
    neighbours += x * previous / kCount;
    previous = x;
  }
  // Five standard errors; the variances of x, x^2, x^3, x^4 are 1, 2, 15, 96.
  EXPECT_NEAR(moment[1], 0.0, 5 * std::sqrt(1.0 / kCount));
  EXPECT_NEAR(moment[2], 1.0, 5 * std::sqrt(2.0 / kCount));
  EXPECT_NEAR(moment[3], 0.0, 5 * std::sqrt(15.0 / kCount));
  EXPECT_NEAR(moment[4], 3.0, 5 * std::sqrt(96.0 / kCount));
  EXPECT_NEAR(neighbours, 0.0, 5 * std::sqrt(1.0 / kCount));
}

}  // namespace
}  // namespace turnlight
