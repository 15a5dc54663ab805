// Proves, on made pictures whose faults are known: clean noisy shading loses nothing, a highlight
// of one pixel is kept, outliers are found from 1 % to 20 % of the pixels, impossible values and
// what the sensor's floor cut off are marked, and nothing outside of the target. Does not prove:
// that an estimate from the rest is right (bench/studies), or anything about outliers in clusters.
#include "estimator/observe/broken_pixels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "base/random.h"

namespace turnlight::estimator::observe {
namespace {

constexpr int kRows = 90, kColumns = 120;
constexpr double kNoise = 0.005;

cv::Mat1b WholeTarget() { return cv::Mat1b(kRows, kColumns, std::uint8_t{255}); }

std::uint64_t Index(int row, int column) {
  return static_cast<std::uint64_t>(row * kColumns + column);
}

cv::Mat1f Picture(double noise, std::uint64_t seed,
                  const std::function<double(int row, int column)>& mean) {
  const RandomStream random(seed, 1);
  cv::Mat1f out(kRows, kColumns);
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column)
      out(row, column) =
          static_cast<float>(mean(row, column) + noise * random.Normal(Index(row, column)));
  return out;
}

double Ramp(int row, int column) { return 0.2 + 0.003 * column + 0.001 * row; }

TEST(BrokenPixels, ANoisyRampHasNone) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const cv::Mat1b broken = FindBrokenPixels(Picture(kNoise, seed, Ramp), WholeTarget());
    EXPECT_EQ(cv::countNonZero(broken), 0) << seed;
  }
  EXPECT_EQ(cv::countNonZero(FindBrokenPixels(Picture(0.0, 1, Ramp), WholeTarget())), 0);
}

// Noise below one step of an 8-bit sensor's numbers makes lone pixels of one step.
TEST(BrokenPixels, StepsOfTheSensorsNumbersAreNoOutliers) {
  for (const double steps : {0.1, 0.3, 0.6, 1.0}) {
    cv::Mat1f picture = Picture(steps / 255.0, 7, Ramp);
    for (float& value : picture) value = std::round(value * 255.0f) / 255.0f;
    EXPECT_EQ(cv::countNonZero(FindBrokenPixels(picture, WholeTarget())), 0) << steps;
  }
}

TEST(BrokenPixels, AShadowWithoutNoiseIsNotFloored) {
  const cv::Mat1f picture = Picture(
      0.0, 1, [](int, int column) { return std::max(0.0, std::sin(0.02 * (column - 12))); });
  EXPECT_EQ(cv::countNonZero(FindBrokenPixels(picture, WholeTarget())), 0);
}

TEST(BrokenPixels, AHighlightOfOnePixelIsKept) {
  cv::Mat1f picture = Picture(kNoise, 1, Ramp);
  picture(40, 60) = 20.0f;
  EXPECT_EQ(cv::countNonZero(FindBrokenPixels(picture, WholeTarget())), 0);
}

// Of the pixels, a share is replaced by anything between black and white.
TEST(BrokenPixels, OutliersAreFoundAndTheOthersKept) {
  for (const double share : {0.01, 0.05, 0.2}) {
    cv::Mat1f picture = Picture(kNoise, 2, Ramp);
    const RandomStream random(3, 2);
    cv::Mat1b replaced(kRows, kColumns, std::uint8_t{0});
    for (int row = 0; row < kRows; ++row)
      for (int column = 0; column < kColumns; ++column) {
        const std::uint64_t i = 2 * Index(row, column);
        if (random.Uniform(i) >= share) continue;
        replaced(row, column) = 1;
        picture(row, column) = static_cast<float>(random.Uniform(i + 1));
      }
    const cv::Mat1b broken = FindBrokenPixels(picture, WholeTarget());
    int gross = 0, found = 0, good = 0, lost = 0;
    for (int row = 0; row < kRows; ++row)
      for (int column = 0; column < kColumns; ++column) {
        const double off = std::abs(static_cast<double>(picture(row, column)) - Ramp(row, column));
        const bool marked = (broken(row, column) & kOutlier) != 0;
        if (replaced(row, column) == 0) {
          ++good;
          lost += broken(row, column) != 0 ? 1 : 0;
        } else if (off > 20.0 * kNoise) {
          ++gross;
          found += marked ? 1 : 0;
        }
      }
    EXPECT_GT(gross, 0.5 * share * kRows * kColumns);
    EXPECT_GE(found, 0.9 * gross) << share;
    EXPECT_LT(lost, 0.03 * good) << share;
  }
}

TEST(BrokenPixels, ImpossibleValuesAreImplausible) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  cv::Mat picture;
  cv::merge(std::vector<cv::Mat>{Picture(kNoise, 4, Ramp), Picture(kNoise, 5, Ramp),
                                 Picture(kNoise, 6, Ramp)},
            picture);
  const float bad[] = {std::numeric_limits<float>::quiet_NaN(), kInfinity, -kInfinity, 1e30f,
                       -1e30f};
  for (int i = 0; i < 5; ++i) picture.at<cv::Vec3f>(10 + 10 * i, 30 + 7 * i)[i % 3] = bad[i];
  const cv::Mat1b broken = FindBrokenPixels(picture, WholeTarget());
  EXPECT_EQ(cv::countNonZero(broken), 5);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(broken(10 + 10 * i, 30 + 7 * i), kImplausible) << bad[i];
}

// Black at the left, 24 sigma at the right; what noise takes below 0 the sensor shows as 0.
TEST(BrokenPixels, FlooredWhereTheMeanIsNearTheFloor) {
  const auto sigmas = [](int column) { return 0.2 * column; };
  cv::Mat1f picture = Picture(kNoise, 7, [&](int, int column) { return kNoise * sigmas(column); });
  picture = cv::max(picture, 0.0f);
  const cv::Mat1b broken = FindBrokenPixels(picture, WholeTarget());
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column) {
      // The mean of 25 pixels is known to 0.2 sigma.
      if (sigmas(column) < 1.0) {
        EXPECT_EQ(broken(row, column), kFloored) << row << " " << column;
      }
      if (sigmas(column) > 3.0) {
        EXPECT_EQ(broken(row, column), 0) << row << " " << column;
      }
    }
}

// Where the noise is cut off everywhere, none is left that its own noise took over the limit: the
// mean of those would be too bright.
TEST(BrokenPixels, NoFlooredPixelIsKeptForBeingBright) {
  const auto dark = [](int column) { return column < 60; };
  cv::Mat1f picture = Picture(
      kNoise, 11, [&](int, int column) { return dark(column) ? 1.7 * kNoise : 30.0 * kNoise; });
  picture = cv::max(picture, 0.0f);
  const cv::Mat1b broken = FindBrokenPixels(picture, WholeTarget());
  for (int row = 4; row < kRows - 4; ++row)
    for (int column = 4; column < kColumns; ++column) {
      if (column < 56) {
        EXPECT_EQ(broken(row, column), kFloored) << row << " " << column;
      }
      if (column >= 64) {
        EXPECT_EQ(broken(row, column), 0) << row << " " << column;
      }
    }
}

// Half the picture is black: the dark side of a ball without noise. That is what the ball sent.
TEST(BrokenPixels, WithoutNoiseNothingIsFloored) {
  const cv::Mat1f picture =
      Picture(0.0, 1, [](int, int column) { return std::max(0.0, 0.01 * (column - 60)); });
  EXPECT_EQ(cv::countNonZero(FindBrokenPixels(picture, WholeTarget())), 0);
}

TEST(BrokenPixels, NothingOutsideOfTheTarget) {
  cv::Mat1b target(kRows, kColumns, std::uint8_t{0});
  target(cv::Rect(20, 15, 80, 60)).setTo(255);
  cv::Mat1f picture = Picture(kNoise, 8, Ramp);
  const RandomStream random(9, 1);
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column)
      if (target(row, column) == 0) {
        const double kind = random.Uniform(Index(row, column));
        picture(row, column) = kind < 0.3   ? std::numeric_limits<float>::quiet_NaN()
                               : kind < 0.6 ? 1e30f
                               : kind < 0.8 ? 0.0f
                                            : 0.9f;
      }
  EXPECT_EQ(cv::countNonZero(FindBrokenPixels(picture, target)), 0);
}

}  // namespace
}  // namespace turnlight::estimator::observe
