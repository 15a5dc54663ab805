// Proves: two pictures of one view differ by what chance gives, whatever their noise is like (of
// light, rounded to 8 bits, cut off at zero, of a mosaic); another brightness, a shift, a spot are
// found; how small an error of brightness or angle is found (the test prints it). Does not prove
// anything of noise that goes together between pixels.
#include "rig/session/picture_difference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>

#include "tests/rig/session/rendered_table.h"

namespace turnlight::rig {
namespace {

cv::Mat1b AllOf(const cv::Mat& image) { return {image.size(), uchar{255}}; }

PictureDifference Compared(const cv::Mat& a, const cv::Mat& b) {
  return ComparePictures(a, b, AllOf(a), TableRadiometry(), false);
}

const cv::Mat& CleanView() {
  static const sim::SyntheticSession rendered = RenderTable(2);
  return rendered.frames[1].image;
}

// Mean and standard deviation of what should be normal with sigma 1, over many seeds.
struct Spread {
  double sum = 0.0, squares = 0.0;
  int count = 0;
  void Add(double value) {
    sum += value;
    squares += value * value;
    ++count;
  }
  double Mean() const { return sum / count; }
  double Sigma() const { return std::sqrt(squares / count - Mean() * Mean()); }
};

// record: the picture with the noise of a seed.
void ExpectChance(const std::function<cv::Mat(std::uint64_t)>& record,
                  const calib::Radiometry& radiometry, bool mosaic) {
  Spread level, shift, brightness;
  double largest = 0.0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const cv::Mat a = record(2 * seed), b = record(2 * seed + 1);
    const PictureDifference found = ComparePictures(a, b, AllOf(a), radiometry, mosaic);
    EXPECT_NEAR(found.rms_in_noise, 1.0, 0.05);
    level.Add(found.level_sigmas);
    shift.Add(found.shift_sigmas);
    brightness.Add(found.brightness / found.brightness_sigma);
    largest = std::max(largest, found.largest_sigmas);
  }
  for (const Spread& spread : {level, shift, brightness}) {
    EXPECT_NEAR(spread.Mean(), 0.0, 0.6);
    EXPECT_NEAR(spread.Sigma(), 1.0, 0.35);
  }
  EXPECT_LT(largest, 5.0);  // of 30 * 300 blocks chance gives about 4
}

TEST(PictureDifference, OneViewDiffersByChance) {
  // The background is 0 and its noise cut off there.
  ExpectChance([](std::uint64_t seed) { return Recorded(CleanView(), seed, 0); }, TableRadiometry(),
               false);
}

TEST(PictureDifference, EightBitsAndABlackLevel) {
  calib::Radiometry radiometry;
  radiometry.black = 16.0;
  radiometry.white = 250.0;
  ExpectChance(
      [](std::uint64_t seed) {
        const cv::Mat levels = CleanView() + cv::Scalar::all(16.0 / 234.0);
        cv::Mat recorded;
        Recorded(levels, seed, 0).convertTo(recorded, CV_8U, 234.0 / kWhite);
        return recorded;
      },
      radiometry, false);
}

TEST(PictureDifference, AMosaic) {
  ExpectChance(
      [](std::uint64_t seed) {
        const cv::Mat recorded = Recorded(CleanView() + cv::Scalar::all(0.05), seed, 0);
        cv::Mat1w mosaic(recorded.size());
        for (int y = 0; y < mosaic.rows; ++y)
          for (int x = 0; x < mosaic.cols; ++x)
            mosaic(y, x) = recorded.at<cv::Vec3w>(y, x)[y % 2 + x % 2];
        return cv::Mat(mosaic);
      },
      TableRadiometry(), true);
}

TEST(PictureDifference, TheSamePicture) {
  const cv::Mat image = Recorded(CleanView(), 1, 0);
  const PictureDifference found = Compared(image, image);
  EXPECT_EQ(found.values, image.total() * 3);
  EXPECT_EQ(found.rms, 0.0);
  EXPECT_EQ(found.largest, 0.0);
  EXPECT_EQ(found.brightness, 0.0);
  const cv::Mat black(40, 40, CV_8U, cv::Scalar(0));
  EXPECT_EQ(Compared(black, black).brightness_sigma, 0.0);
}

TEST(PictureDifference, ASpotIsFoundWhereItIs) {
  const cv::Mat a = Recorded(CleanView(), 1, 0);
  cv::Mat levels = CleanView().clone();
  levels(cv::Rect(200, 100, 6, 6)) += cv::Scalar::all(0.02);
  const PictureDifference found = Compared(a, Recorded(levels, 2, 0));
  EXPECT_GT(found.largest_sigmas, 7.0);
  EXPECT_EQ(found.largest_at, cv::Point(200, 104));  // the middle of its block
}

TEST(PictureDifference, WhatIsNotComparable) {
  const cv::Mat a(32, 32, CV_32F, cv::Scalar(2.0 * kWhite));
  EXPECT_EQ(Compared(a, a).values, 0U);  // saturated in both
  cv::Mat b(32, 32, CV_32F, cv::Scalar(0.5 * kWhite));
  EXPECT_GT(Compared(a, b).largest, 0.4);  // in one only: that is a difference
  b = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(Compared(a, b).values, 0U);
  EXPECT_EQ(ComparePictures(b, b, cv::Mat1b(32, 32, uchar{0}), TableRadiometry(), false).values,
            0U);
}

// The limit for the largest of 36 frames: 3.96.
constexpr double kLimit = 3.96;

// The figures of docs/compare.md.
TEST(PictureDifference, HowSmallAWrongAngleIsFound) {
  for (const double error_deg : {0.01, 0.02, 0.03, 0.05, 0.1, 0.2, 0.5}) {
    const cv::Mat wrong = RenderTable(2, error_deg).frames[1].image;
    int found = 0;
    Spread sigmas;
    constexpr int kSeeds = 20;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
      const PictureDifference difference =
          Compared(Recorded(CleanView(), 2 * seed, 0), Recorded(wrong, 2 * seed + 1, 0));
      sigmas.Add(difference.shift_sigmas);
      found += difference.shift_sigmas > kLimit ? 1 : 0;
    }
    std::printf("angle wrong by %.2f degrees: shifts of blocks %.1f sigmas, found in %d of %d\n",
                error_deg, sigmas.Mean(), found, kSeeds);
    if (error_deg >= 0.05) {
      EXPECT_EQ(found, kSeeds);
    }
  }
}

TEST(PictureDifference, HowSmallAChangeOfBrightnessIsFound) {
  for (const double change : {0.0002, 0.0005, 0.001, 0.002, 0.005, 0.01}) {
    const cv::Mat brighter = CleanView() * (1.0 + change);
    int found = 0;
    Spread sigmas, measured;
    constexpr int kSeeds = 20;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
      const PictureDifference difference =
          Compared(Recorded(CleanView(), 2 * seed, 0), Recorded(brighter, 2 * seed + 1, 0));
      const double in_sigmas = difference.brightness / difference.brightness_sigma;
      sigmas.Add(in_sigmas);
      measured.Add(difference.brightness);
      found += in_sigmas > kLimit ? 1 : 0;
    }
    std::printf("brighter by %.2f %%: measured %.3f %%, %.1f sigmas, found in %d of %d\n",
                100.0 * change, 100.0 * measured.Mean(), sigmas.Mean(), found, kSeeds);
    EXPECT_NEAR(measured.Mean(), change, 2e-4);
    if (change >= 0.001) {
      EXPECT_EQ(found, kSeeds);
    }
  }
}

}  // namespace
}  // namespace turnlight::rig
