// Proves: digital numbers become radiance as the design's section 2 says (black, white, encoding,
// exposure, gain, white balance), negative values stay, clipped pixels are flagged on DN, and
// Encode is the inverse for every depth and encoding; vignetting is taken out and put in; a value's
// variance is what many draws of its noise show. Does not prove: that a sensor follows its declared
// encoding (that is a response calibration).
#include "calib/radiometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace turnlight::calib {
namespace {

Radiometry Make(Encoding encoding, double black, double white) {
  Radiometry radiometry;
  radiometry.encoding = encoding;
  radiometry.black = black;
  radiometry.white = white;
  radiometry.curve = {{0.0, 0.0}, {0.2, 0.1}, {0.5, 0.45}, {1.0, 1.0}};  // used by kCurve
  return radiometry;
}

float Radiance(double dn, const Radiometry& radiometry, const Exposure& exposure = {}) {
  return Linearise(cv::Mat(1, 1, CV_32F, cv::Scalar(dn)), radiometry, exposure)
      .radiance.at<float>(0, 0);
}

TEST(Radiometry, KnownAnswers) {
  EXPECT_FLOAT_EQ(Radiance(32, Make(Encoding::kLinear, 16, 32)), 1.0f);
  EXPECT_FLOAT_EQ(Radiance(20, Make(Encoding::kLinear, 16, 32)), 0.25f);
  // IEC 61966-2-1: half of white's code is 21.4 % of its light; below 0.04045 it is linear.
  EXPECT_NEAR(Radiance(0.5, Make(Encoding::kSrgb, 0, 1)), 0.2140411, 1e-7);
  EXPECT_NEAR(Radiance(0.02, Make(Encoding::kSrgb, 0, 1)), 0.02 / 12.92, 1e-9);
  EXPECT_NEAR(Radiance(0.5, Make(Encoding::kGamma, 0, 1)), std::pow(0.5, 2.2), 1e-7);
}

TEST(Radiometry, NegativeValuesAreKept) {
  EXPECT_FLOAT_EQ(Radiance(12, Make(Encoding::kLinear, 16, 32)), -0.25f);
  EXPECT_NEAR(Radiance(-0.5, Make(Encoding::kGamma, 0, 1)), -std::pow(0.5, 2.2), 1e-7);
  EXPECT_NEAR(Radiance(-0.5, Make(Encoding::kSrgb, 0, 1)), -0.5 / 12.92, 1e-7);
  // Also from integers, whose black lies above 0.
  const cv::Mat dark(1, 1, CV_16U, cv::Scalar(100));
  EXPECT_FLOAT_EQ(Linearise(dark, Make(Encoding::kLinear, 200, 1200), {}).radiance.at<float>(0, 0),
                  -0.1f);
}

TEST(Radiometry, ExposureAndGain) {
  Radiometry radiometry = Make(Encoding::kLinear, 0, 1);
  EXPECT_EQ(ExposureFactor(radiometry, {}), 1.0);
  radiometry.reference_exposure_us = 8000.0;
  radiometry.reference_gain_db = 6.0;
  // Twice the time: half the radiance for the same DN. 20 dB more gain: a tenth.
  EXPECT_NEAR(ExposureFactor(radiometry, {16000.0, 6.0}), 0.5, 1e-15);
  EXPECT_NEAR(ExposureFactor(radiometry, {8000.0, 26.0}), 0.1, 1e-15);
  EXPECT_NEAR(Radiance(0.4, radiometry, {16000.0, 26.0}), 0.02, 1e-8);
  // The encoding is undone before the scaling.
  radiometry.encoding = Encoding::kGamma;
  EXPECT_NEAR(Radiance(0.5, radiometry, {16000.0, 6.0}), 0.5 * std::pow(0.5, 2.2), 1e-8);
}

TEST(Radiometry, WhiteBalanceDivides) {
  Radiometry radiometry = Make(Encoding::kLinear, 0, 255);
  radiometry.white_balance = {0.5, 1.25, 2.0};
  const cv::Mat white(1, 1, CV_8UC3, cv::Scalar(255, 255, 255));
  const auto colour = Linearise(white, radiometry, {}).radiance.at<cv::Vec3f>(0, 0);
  EXPECT_FLOAT_EQ(colour[0], 2.0f);
  EXPECT_FLOAT_EQ(colour[1], 0.8f);
  EXPECT_FLOAT_EQ(colour[2], 0.5f);
  const cv::Mat grey(1, 1, CV_8U, cv::Scalar(255));
  EXPECT_FLOAT_EQ(Linearise(grey, radiometry, {}).radiance.at<float>(0, 0), 0.8f);
}

TEST(Radiometry, SaturationIsTestedOnDn) {
  Radiometry radiometry = Make(Encoding::kSrgb, 10, 200);
  radiometry.reference_exposure_us = 1.0;
  cv::Mat image = (cv::Mat_<std::uint8_t>(1, 4) << 0, 199, 200, 255);
  const auto by_white = Linearise(image, radiometry, {100.0, 0.0}).saturated;
  EXPECT_EQ(cv::countNonZero(by_white != (cv::Mat_<std::uint8_t>(1, 4) << 0, 0, 255, 255)), 0);
  radiometry.saturation = 250.0;
  const auto by_own = Linearise(image, radiometry, {100.0, 0.0}).saturated;
  EXPECT_EQ(cv::countNonZero(by_own != (cv::Mat_<std::uint8_t>(1, 4) << 0, 0, 0, 255)), 0);
}

TEST(Radiometry, OneClippedChannelFlagsThePixel) {
  cv::Mat image(1, 2, CV_16UC3, cv::Scalar(5, 6, 7));
  image.at<cv::Vec3w>(0, 1)[2] = 1000;
  const auto linear = Linearise(image, Make(Encoding::kLinear, 0, 1000), {});
  EXPECT_EQ(linear.saturated(0, 0), 0);
  EXPECT_EQ(linear.saturated(0, 1), 255);
}

TEST(Radiometry, NotFiniteIsFlaggedAndHarmless) {
  for (const float bad : {NAN, INFINITY, -INFINITY, std::numeric_limits<float>::max()}) {
    cv::Mat image(1, 2, CV_32FC3, cv::Scalar(0.25, 0.25, 0.25));
    image.at<cv::Vec3f>(0, 1)[0] = bad;
    // The gain makes even the largest finite float overflow.
    const auto linear = Linearise(image, Make(Encoding::kLinear, 0, 1), {{}, -40.0});
    EXPECT_EQ(linear.saturated(0, 0), 0);
    EXPECT_EQ(linear.saturated(0, 1), 255) << bad;
    EXPECT_TRUE(cv::checkRange(linear.radiance)) << bad;
    EXPECT_FLOAT_EQ(linear.radiance.at<cv::Vec3f>(0, 1)[1], 25.0f);
  }
}

// Every DN of 8 and 16 bits, in every encoding, comes back as itself.
TEST(Radiometry, EncodeInvertsIntegers) {
  for (const int depth : {CV_8U, CV_16U}) {
    const int count = depth == CV_8U ? 256 : 65536;
    cv::Mat all(1, count, CV_MAKETYPE(depth, 3));
    for (int i = 0; i < count; ++i) {
      if (depth == CV_8U)
        all.at<cv::Vec3b>(0, i) = cv::Vec3b::all(static_cast<std::uint8_t>(i));
      else
        all.at<cv::Vec3w>(0, i) = cv::Vec3w::all(static_cast<std::uint16_t>(i));
    }
    for (const Encoding encoding :
         {Encoding::kLinear, Encoding::kSrgb, Encoding::kGamma, Encoding::kCurve}) {
      Radiometry radiometry = Make(encoding, count / 16, count * 0.9);
      radiometry.reference_exposure_us = 5000.0;
      radiometry.white_balance = {0.7, 1.0, 1.9};
      const Exposure exposure{1234.0, 7.5};
      const cv::Mat radiance = Linearise(all, radiometry, exposure).radiance;
      const cv::Mat back = Encode(radiance, radiometry, exposure, depth);
      ASSERT_EQ(back.type(), all.type());
      EXPECT_EQ(cv::norm(back, all, cv::NORM_INF), 0.0) << depth << static_cast<int>(encoding);
    }
  }
}

TEST(Radiometry, EncodeInvertsFloats) {
  cv::Mat image(1, 1000, CV_32F);
  for (int i = 0; i < 1000; ++i) image.at<float>(0, i) = -0.5f + 0.0025f * static_cast<float>(i);
  for (const Encoding encoding :
       {Encoding::kLinear, Encoding::kSrgb, Encoding::kGamma, Encoding::kCurve}) {
    const Radiometry radiometry = Make(encoding, 0.1, 0.8);
    const cv::Mat radiance = Linearise(image, radiometry, {}).radiance;
    const cv::Mat back = Encode(radiance, radiometry, {}, CV_32F);
    EXPECT_LT(cv::norm(back, image, cv::NORM_INF), 5e-7) << static_cast<int>(encoding);
  }
}

TEST(Radiometry, EncodeRoundsAndClips) {
  const Radiometry radiometry = Make(Encoding::kLinear, 0, 100);
  const cv::Mat radiance =
      (cv::Mat_<float>(1, 7) << -0.5f, 0.004f, 0.006f, 2.549f, 2.56f, NAN, INFINITY);
  const cv::Mat dn = Encode(radiance, radiometry, {}, CV_8U);
  const cv::Mat expected = (cv::Mat_<std::uint8_t>(1, 7) << 0, 0, 1, 255, 255, 0, 255);
  EXPECT_EQ(cv::norm(dn, expected, cv::NORM_INF), 0.0) << dn;
  EXPECT_FLOAT_EQ(Encode(radiance, radiometry, {}, CV_32F).at<float>(0, 0), -50.0f);
}

TEST(Radiometry, VignettingIsTakenOutAndPutIn) {
  Radiometry radiometry = Make(Encoding::kGamma, 0, 1);
  radiometry.vignetting = Vignetting{1.0, 0.0, 2.0, {-0.2, -0.04}};
  const cv::Mat image(1, 5, CV_32F, cv::Scalar(0.5));
  const LinearImage linear = Linearise(image, radiometry, {});
  const double whole = std::pow(0.5, 2.2);
  EXPECT_NEAR(linear.radiance.at<float>(0, 1), whole, 1e-7);
  EXPECT_NEAR(linear.radiance.at<float>(0, 2), whole / (1.0 - 0.2 / 4 - 0.04 / 16), 1e-7);
  EXPECT_NEAR(linear.radiance.at<float>(0, 3), whole / 0.76, 1e-7);
  EXPECT_EQ(linear.saturated(0, 3), 0);
  EXPECT_EQ(linear.saturated(0, 4), 255) << "beyond what was measured";
  const cv::Mat back = Encode(linear.radiance, radiometry, {}, CV_32F);
  EXPECT_LT(cv::norm(back.colRange(0, 4), image.colRange(0, 4), cv::NORM_INF), 1e-6);
}

TEST(Radiometry, NoVarianceWithoutANoiseModel) {
  EXPECT_TRUE(Linearise(cv::Mat(2, 2, CV_8U, cv::Scalar(3)), Radiometry{}, {}).variance.empty());
}

// Through encoding, exposure and vignetting, with rounding: as many draws show it.
TEST(Radiometry, TheVarianceIsThatOfManyDraws) {
  for (const Encoding encoding : {Encoding::kLinear, Encoding::kGamma}) {
    Radiometry radiometry = Make(encoding, 10, 250);
    radiometry.reference_exposure_us = 1000.0;
    radiometry.noise = NoiseModel{0.8, 0.1, 0.0};
    radiometry.vignetting = Vignetting{0.0, 0.0, 1e6, {-0.3}};
    const Exposure exposure{500.0, 6.0};
    const double gain = std::pow(10.0, 0.3), linear = 90.0;  // of 240 DN
    const double sigma = std::sqrt(gain * gain * 0.64 + gain * 0.1 * linear);
    cv::Mat1f noisy(200, 200);
    cv::RNG random(5);
    random.fill(noisy, cv::RNG::NORMAL, linear / 240.0, sigma / 240.0);
    Radiometry plain = radiometry;
    plain.reference_exposure_us.reset();
    plain.vignetting.reset();
    const cv::Mat dn = Encode(noisy, plain, {}, CV_8U);
    const LinearImage out = Linearise(dn, radiometry, exposure);
    cv::Scalar mean, deviation;
    cv::meanStdDev(out.radiance, mean, deviation);
    const double stated = cv::mean(out.variance)[0];
    EXPECT_NEAR(deviation[0] * deviation[0] / stated, 1.0, 0.03) << static_cast<int>(encoding);
  }
}

// What noise made bright would count for less than what it made dark.
TEST(Radiometry, AValueHasNoSayInItsOwnVariance) {
  Radiometry radiometry = Make(Encoding::kLinear, 0, 1000);
  radiometry.noise = NoiseModel{1.0, 1.0, std::nullopt};
  cv::Mat image(5, 5, CV_16U, cv::Scalar(100));
  const float before = Linearise(image, radiometry, {}).variance(2, 2);
  image.at<std::uint16_t>(2, 2) = 900;
  EXPECT_EQ(Linearise(image, radiometry, {}).variance(2, 2), before);
  EXPECT_GT(Linearise(image, radiometry, {}).variance(1, 2), before);
}

TEST(Radiometry, EmptyPicture) {
  const auto linear = Linearise(cv::Mat(0, 0, CV_8UC1), Radiometry{}, {});
  EXPECT_TRUE(linear.radiance.empty());
}

}  // namespace
}  // namespace turnlight::calib
