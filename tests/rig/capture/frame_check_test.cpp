// Proves: pictures that are black, saturated, or far from their predecessors' brightness are told
// by value, with what was measured and what is allowed; the closure comparison sees a shift of one
// pixel and not the noise. Does not prove: that the thresholds suit every scene; they are settings.
#include "rig/capture/frame_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/random.h"

namespace turnlight::rig {
namespace {

using testing::AllOf;
using testing::HasSubstr;

calib::Radiometry Sensor() {
  calib::Radiometry radiometry;
  radiometry.black = 200.0;
  radiometry.white = 10200.0;
  return radiometry;
}

cv::Mat Flat(double level, int type = CV_16U) {
  return cv::Mat(20, 20, type, cv::Scalar::all(200.0 + 10000.0 * level));
}

TEST(FrameCheck, StatisticsInClosedForm) {
  cv::Mat image = Flat(0.1, CV_16UC3);
  for (int x = 0; x < 10; ++x) image.at<cv::Vec3w>(3, x) = {10200, 200, 200};
  const auto found = MeasureFrame(image, Sensor());
  EXPECT_DOUBLE_EQ(found.saturated_share, 10.0 / 400.0);
  EXPECT_NEAR(found.mean_level, (390 * 0.1 + 10.0 / 3.0) / 400.0, 1e-6);
  EXPECT_NEAR(found.bright_level, 1.0, 1e-6);
  image.at<cv::Vec3w>(3, 0) = image.at<cv::Vec3w>(0, 0);
  for (int x = 4; x < 10; ++x) image.at<cv::Vec3w>(3, x) = image.at<cv::Vec3w>(0, 0);
  EXPECT_NEAR(MeasureFrame(image, Sensor()).bright_level, 0.1, 1e-6);  // 3 of 400 are below 1 %
}

TEST(FrameCheck, NotANumberCountsAsSaturated) {
  cv::Mat image = Flat(0.1, CV_32F);
  image.at<float>(0, 0) = std::numeric_limits<float>::quiet_NaN();
  image.at<float>(0, 1) = std::numeric_limits<float>::infinity();
  image.at<float>(0, 2) = -std::numeric_limits<float>::infinity();
  const auto found = MeasureFrame(image, Sensor());
  EXPECT_DOUBLE_EQ(found.saturated_share, 3.0 / 400.0);
  EXPECT_TRUE(std::isfinite(found.mean_level));
}

TEST(FrameCheck, Verdicts) {
  const FrameGate gate;
  const std::vector<double> before{0.1, 0.11, 0.09};
  EXPECT_EQ(CheckFrame(Flat(0.1), Sensor(), gate, before).verdict, FrameVerdict::kGood);
  EXPECT_EQ(CheckFrame(Flat(0.1), Sensor(), gate, before).text, "");
  const auto black = CheckFrame(Flat(0.004), Sensor(), gate, {});
  EXPECT_EQ(black.verdict, FrameVerdict::kAllBlack);
  EXPECT_THAT(black.text, AllOf(HasSubstr("0.4 % of white"), HasSubstr("at least 0.5 %")));
  const auto saturated = CheckFrame(Flat(1.0), Sensor(), gate, before);
  EXPECT_EQ(saturated.verdict, FrameVerdict::kSaturated);
  EXPECT_THAT(saturated.text, AllOf(HasSubstr("100 %"), HasSubstr("allowed are 25 %: divide the "
                                                                  "exposure by 8")));
  const auto off = CheckFrame(Flat(0.04), Sensor(), gate, before);
  EXPECT_EQ(off.verdict, FrameVerdict::kLampOff);
  EXPECT_THAT(off.text, AllOf(HasSubstr("0.4 of the median of the 3"), HasSubstr("0.5 or more")));
  EXPECT_EQ(CheckFrame(Flat(0.3), Sensor(), gate, before).verdict, FrameVerdict::kLampBright);
  // Without enough predecessors nothing is said about the lamp.
  EXPECT_EQ(CheckFrame(Flat(0.04), Sensor(), gate, {0.1, 0.1}).verdict, FrameVerdict::kGood);
}

// A scene as a sensor with this exposure gives it: level_of(u), u rising evenly from 0 to 1.
template <typename LevelOf>
cv::Mat Exposed(const LevelOf& level_of, double exposure) {
  cv::Mat1w image(100, 100);
  for (int i = 0; i < 10000; ++i) {
    const double level = exposure * level_of((i + 0.5) / 10000.0);
    image(i / 100, i % 100) =
        cv::saturate_cast<std::uint16_t>(std::min(200.0 + 10000.0 * level, 12000.0));
  }
  return image;
}

// Follows the advice; the exposures that it led to, until there is none.
template <typename LevelOf>
std::vector<double> Followed(const LevelOf& level_of, double exposure) {
  std::vector<double> exposures{exposure};
  while (exposures.size() < 10) {
    const auto found = MeasureFrame(Exposed(level_of, exposures.back()), Sensor());
    if (ExposureAdvice(found).empty()) break;
    exposures.push_back(exposures.back() * found.exposure_factor);
  }
  return exposures;
}

// 4095 above a black of 100 is 1 but for rounding.
TEST(FrameCheck, WhiteIsSaturatedWhateverTheRounding) {
  calib::Radiometry radiometry;
  for (int black = 0; black < 200; ++black) {
    radiometry.black = black;
    radiometry.white = 4095.0;
    const cv::Mat white(4, 4, CV_16U, cv::Scalar(4095)), below(4, 4, CV_16U, cv::Scalar(4094));
    EXPECT_EQ(MeasureFrame(white, radiometry).saturated_share, 1.0) << black;
    EXPECT_EQ(MeasureFrame(below, radiometry).saturated_share, 0.0) << black;
  }
}

TEST(FrameCheck, AdviceOfADarkPictureIsExact) {
  const auto ramp = [](double u) { return u; };  // the brightest thousandth begins at 0.999
  for (const double exposure : {0.01, 0.04, 0.4}) {
    const auto followed = Followed(ramp, exposure);
    ASSERT_EQ(followed.size(), 2u) << exposure;
    EXPECT_NEAR(followed[1], 0.8, 0.04) << exposure;
  }
  EXPECT_EQ(ExposureAdvice(MeasureFrame(Exposed(ramp, 0.04), Sensor())),
            "mean level 2 % of white: multiply the exposure by 20");
  EXPECT_EQ(ExposureAdvice(MeasureFrame(Exposed(ramp, 0.4), Sensor())),
            "mean level 20 % of white: double the exposure");
  EXPECT_EQ(ExposureAdvice(MeasureFrame(Exposed(ramp, 0.9), Sensor())), "");
  EXPECT_EQ(ExposureAdvice(MeasureFrame(Flat(0.0), Sensor())),
            "mean level 0 % of white: multiply the exposure by 100 or more");
}

TEST(FrameCheck, AdviceOfAClippedPictureGetsThere) {
  const auto exponential = [](double u) { return -0.2 * std::log(1.0 - u); };
  const auto disc = [](double u) { return u > 0.7 ? 1.0 : 0.01; };
  const auto glints = [](double u) { return 0.2 * u + (u > 0.995 ? 1.0 : 0.0); };
  EXPECT_EQ(ExposureAdvice(MeasureFrame(Exposed(exponential, 1.3), Sensor())),
            "2.1 % clipped: halve the exposure");
  const auto ends_well = [](const auto& scene, double exposure, std::size_t steps) {
    const auto followed = Followed(scene, exposure);
    EXPECT_LE(followed.size() - 1, steps) << exposure;
    const auto end = MeasureFrame(Exposed(scene, followed.back()), Sensor());
    EXPECT_LE(end.saturated_share, 0.001) << exposure;
    EXPECT_GT(end.exposure_factor, 0.7) << exposure;
    EXPECT_LT(end.exposure_factor, 1.6) << exposure;
  };
  for (const double exposure : {1.3, 2.0, 5.0, 20.0}) ends_well(exponential, exposure, 4);
  for (const double exposure : {1.1, 3.0, 6.0}) ends_well(disc, exposure, 5);
  for (const double exposure : {1.0, 3.0}) ends_well(glints, exposure, 5);
}

cv::Mat Scene(std::uint64_t seed, int shift) {
  cv::Mat1w image(64, 64);
  const RandomStream random(seed, 0);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const double r = std::hypot(x - 32 - shift, y - 32);
      const double level = r < 25 ? 0.3 + 0.2 * std::cos(0.4 * r) : 0.0;
      image(y, x) = cv::saturate_cast<std::uint16_t>(
          200.0 + 10000.0 * level + 20.0 * random.Normal(static_cast<std::uint64_t>(64 * y + x)));
    }
  return image;
}

TEST(FrameCheck, ClosureSeesAShiftButNotNoise) {
  const auto same = CompareFrames(Scene(1, 0), Scene(2, 0), Sensor());
  EXPECT_NEAR(same.noise_rms, 20.0 * std::sqrt(2.0) / 10000.0, 2e-4);
  EXPECT_NEAR(same.Sigmas(), 1.0, 0.1);
  EXPECT_NEAR(static_cast<double>(same.pixels), 3.14 * 25 * 25, 60);
  EXPECT_GT(CompareFrames(Scene(1, 0), Scene(2, 1), Sensor()).Sigmas(), 4.0);
  EXPECT_EQ(CompareFrames(Scene(1, 0), Scene(1, 0), Sensor()).Sigmas(), 0.0);
  EXPECT_EQ(CompareFrames(Flat(0), Flat(0), Sensor()).pixels, 0u);
}

TEST(FrameCheck, BlocksSeeWhatIsFarBelowThePixelsNoise) {
  const cv::Mat first = Scene(1, 0);
  cv::Mat brighter;  // by a tenth of the noise
  cv::add(Scene(2, 0), cv::Scalar::all(3.0), brighter);
  const auto same = CompareFrames(first, Scene(2, 0), Sensor());
  const auto other = CompareFrames(first, brighter, Sensor());
  EXPECT_NEAR(same.block_sigmas, 1.0, 0.35);  // of some thirty blocks
  EXPECT_NEAR(same.block_share, 20.0 * std::sqrt(2.0) / 8.0 / 3000.0, 5e-4);
  EXPECT_NEAR(other.Sigmas(), same.Sigmas(), 0.02);
  EXPECT_GT(other.block_sigmas, same.block_sigmas + 0.2);
  EXPECT_GT(CompareFrames(first, Scene(2, 1), Sensor()).block_sigmas, 10.0);
  EXPECT_EQ(CompareFrames(Flat(0), Flat(0), Sensor()).block_sigmas, 0.0);
}

}  // namespace
}  // namespace turnlight::rig
