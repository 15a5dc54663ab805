// Proves: a bracket becomes the inverse-variance mean of what is neither clipped nor cut off, in
// the reference's radiance, without bias and as precise as its model says over five decades; the
// validity map, and that readers see as saturated what every exposure clipped; refusals. Does not
// prove: that a camera's noise follows the model.
#include "rig/capture/exposure_merge.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "calib/radiometry.h"

namespace turnlight::rig {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const std::vector<double> kExposures{8000.0, 500.0, 64000.0};

calib::Radiometry Raw(double black = 100.0) {
  calib::Radiometry radiometry;
  radiometry.black = black;
  radiometry.white = black + 4000.0;
  return RawRadiometry(radiometry, kExposures, 0.0);
}

cv::Mat Grey(double dn, int width = 1, int height = 1) {
  return cv::Mat(height, width, CV_16U, cv::Scalar(dn));
}

MergedFrame Merge(const std::vector<cv::Mat>& images, const calib::Radiometry& radiometry,
                  const SensorNoise& noise = {}) {
  std::vector<ExposedImage> bracket;
  for (std::size_t i = 0; i < images.size(); ++i)
    bracket.push_back({images[i], {kExposures[i], 0.0}});
  const auto merged = MergeExposures(bracket, radiometry, noise);
  EXPECT_TRUE(merged) << merged.error().text;
  return merged.value_or(MergedFrame{});
}

TEST(ExposureMerge, OneExposurePassesThrough) {
  const cv::Mat raw = Grey(77);
  const auto merged = MergeExposures({{raw, {123.0, 2.0}}}, {}, {});
  ASSERT_TRUE(merged);
  EXPECT_EQ(merged->image.data, raw.data);
  EXPECT_TRUE(merged->validity.empty());
  EXPECT_EQ(merged->exposure.exposure_us, 123.0);
  EXPECT_EQ(merged->exposure.gain_db, 2.0);
}

TEST(ExposureMerge, IsTheInverseVarianceMean) {
  // Shares of white 0.1 and 0.00625 of the exposures 8000 and 500; the long one is clipped.
  SensorNoise noise;
  noise.read_noise_dn = 3.0;
  noise.dn_per_electron = 0.5;
  const auto merged = Merge({Grey(500), Grey(130), Grey(4100)}, Raw(), noise);
  const double x[] = {0.1, 30.0 / 4000.0 * 16.0};
  const double first = (0.1 + 30.0 / 4000.0) / (1.0 + 1.0 / 16.0);
  const double weight[] = {1.0 / (9.0 + 1.0 / 12.0 + 0.5 * first * 4000.0),
                           1.0 / ((9.0 + 1.0 / 12.0 + 0.5 * first * 4000.0 / 16.0) * 16.0 * 16.0)};
  const double expected = (weight[0] * x[0] + weight[1] * x[1]) / (weight[0] + weight[1]);
  EXPECT_NEAR(merged.image.at<float>(0, 0), expected, 1e-7);
  EXPECT_EQ(merged.validity(0, 0), 255);
  EXPECT_EQ(merged.exposure.exposure_us, 8000.0);
}

TEST(ExposureMerge, OrderDoesNotMatterAndGainCounts) {
  const auto radiometry = Raw();
  const auto one =
      MergeExposures({{Grey(500), {8000.0, 0.0}}, {Grey(900), {8000.0, 6.0}}}, radiometry, {});
  const auto two =
      MergeExposures({{Grey(900), {8000.0, 6.0}}, {Grey(500), {8000.0, 0.0}}}, radiometry, {});
  ASSERT_TRUE(one && two);
  EXPECT_EQ(one->image.at<float>(0, 0), two->image.at<float>(0, 0));
  EXPECT_GT(one->image.at<float>(0, 0), 0.1f);
  EXPECT_LT(one->image.at<float>(0, 0), static_cast<float>(0.2 * std::pow(10.0, -0.3)) + 1e-6f);
}

// A ramp over five decades, photographed thrice by a 12-bit sensor with the noise of the model.
TEST(ExposureMerge, RecoversFiveDecadesWithoutBias) {
  constexpr int kSteps = 51;
  constexpr int kRepeats = 400;
  SensorNoise noise;
  noise.read_noise_dn = 2.0;
  noise.dn_per_electron = 0.25;
  const auto radiometry = Raw();
  std::vector<cv::Mat> images;
  for (std::size_t e = 0; e < kExposures.size(); ++e) {
    cv::Mat1w image(kSteps * 3, kRepeats);
    for (int step = 0; step < kSteps; ++step) {
      const double radiance = 1.5e-4 * std::pow(10.0, 0.1 * step);  // to 15, where the short clips
      const double dn = radiance * kExposures[e] / kExposures[0] * 4000.0;
      const double sigma = std::sqrt(4.0 + 0.25 * dn);
      const RandomStream random(5, e * 100 + static_cast<std::size_t>(step));
      for (int x = 0; x < kRepeats; ++x)
        for (int row = 0; row < 3; ++row)  // so that neighbours of a step are of the same
          image(3 * step + row, x) = cv::saturate_cast<std::uint16_t>(std::min(
              100.0 + dn + sigma * random.Normal(static_cast<std::uint64_t>(3 * x + row)), 4100.0));
    }
    images.push_back(image);
  }
  const auto merged = Merge(images, radiometry, noise);
  for (int step = 0; step < kSteps; ++step) {
    const double truth = 1.5e-4 * std::pow(10.0, 0.1 * step);
    double inverse = 0.0;
    for (const double exposure : kExposures) {
      const double factor = exposure / kExposures[0];
      const double dn = truth * factor * 4000.0;
      const double sigma = std::sqrt(4.0 + 1.0 / 12.0 + 0.25 * dn);
      if (dn + 5.0 * sigma < 4000.0) inverse += std::pow(factor * 4000.0 / sigma, 2.0);
    }
    if (inverse == 0.0) continue;  // the top, half clipped
    double mean = 0.0;
    double square = 0.0;
    for (int x = 0; x < kRepeats; ++x) {
      const double error = merged.image.at<float>(3 * step + 1, x) - truth;
      mean += error / kRepeats;
      square += error * error / kRepeats;
      EXPECT_EQ(merged.validity(3 * step + 1, x), 255);
    }
    // A step where one exposure is about to clip loses part of it: worse than the model, not
    // biased.
    const double sigma = 1.0 / std::sqrt(inverse);
    EXPECT_LT(std::abs(mean), 5.0 * std::sqrt(square / kRepeats)) << truth;
    EXPECT_GT(std::sqrt(square), 0.7 * sigma) << truth;
    EXPECT_LT(std::sqrt(square), 1.35 * sigma) << truth;
  }
}

TEST(ExposureMerge, ValidityNeedsOneGoodSamplePerChannel) {
  const auto radiometry = Raw();
  cv::Mat clipped_once(1, 1, CV_16UC3, cv::Scalar(4100, 300, 0));
  cv::Mat good(1, 1, CV_16UC3, cv::Scalar(400, 120, 110));
  cv::Mat dark(1, 1, CV_16UC3, cv::Scalar(400, 300, 0));
  EXPECT_EQ(Merge({clipped_once, good}, radiometry).validity(0, 0), 255);
  EXPECT_EQ(Merge({dark, dark}, radiometry).validity(0, 0), 0);  // blue is cut off in both
  EXPECT_EQ(Merge({good, clipped_once}, radiometry).validity(0, 0), 255);
  EXPECT_EQ(Merge({clipped_once, clipped_once}, radiometry).validity(0, 0), 0);
  // Cut off in all: the longest exposure's value. 8000 us: (0 - 100) / 4000.
  EXPECT_FLOAT_EQ(Merge({dark, dark}, radiometry).image.at<cv::Vec3f>(0, 0)[2], -0.025f);
}

TEST(ExposureMerge, ZeroIsAMeasurementWhenBlackIsZero) {
  const auto radiometry = Raw(0.0);
  EXPECT_EQ(Merge({Grey(0), Grey(0)}, radiometry).validity(0, 0), 255);
  SensorNoise noise;
  noise.black_limit_dn = 0.0;
  EXPECT_EQ(Merge({Grey(0), Grey(0)}, radiometry, noise).validity(0, 0), 0);
}

TEST(ExposureMerge, NeighboursOfClippedPixelsTakeAnotherExposure) {
  cv::Mat long_exposure = Grey(1700, 5, 5);  // 0.4, with blooming around the clipped pixel
  long_exposure.at<std::uint16_t>(2, 2) = 4100;
  long_exposure.at<std::uint16_t>(1, 1) = 2900;
  const cv::Mat short_exposure = Grey(200, 5, 5);  // 0.025, that is 0.4 of the reference
  const auto merged = Merge({long_exposure, short_exposure}, Raw());
  EXPECT_NEAR(merged.image.at<float>(1, 1), 0.4, 1e-6);
  EXPECT_NEAR(merged.image.at<float>(2, 2), 0.4, 1e-6);
  EXPECT_NEAR(merged.image.at<float>(0, 0), 0.4, 1e-6);
  // If it is the only exposure that is not clipped itself, it counts.
  const auto alone = Merge({long_exposure, long_exposure}, Raw());
  EXPECT_EQ(alone.validity(1, 1), 255);
  EXPECT_EQ(alone.validity(2, 2), 0);
}

TEST(ExposureMerge, ReadersSeeWhatIsClippedInAllAsSaturated) {
  calib::Radiometry raw = Raw();
  raw.saturation = 4000.0;
  raw.noise = calib::NoiseModel{3.0, 0.5, 0.0};
  const auto session = SessionRadiometry(raw, kExposures, 0.0);
  EXPECT_DOUBLE_EQ(session.SaturationDn(), 3900.0 / 4000.0 * 16.0);
  EXPECT_EQ(session.black, 0.0);
  EXPECT_EQ(session.white, 1.0);
  cv::Mat short_exposure = Grey(3999, 2, 1);
  short_exposure.at<std::uint16_t>(0, 1) = 4000;
  const auto merged = Merge({Grey(4095, 2, 1), short_exposure, Grey(4095, 2, 1)}, raw);
  const auto linear = calib::Linearise(merged.image, session, merged.exposure);
  EXPECT_EQ(linear.saturated(0, 0), 0);
  EXPECT_EQ(linear.saturated(0, 1), 255);
  EXPECT_NEAR(linear.radiance.at<float>(0, 0), 3899.0 / 4000.0 * 16.0, 1e-5);
  // One exposure: nothing changes but the references.
  const auto single = SessionRadiometry(raw, {500.0}, 3.0);
  EXPECT_EQ(single.SaturationDn(), 4000.0);
  EXPECT_TRUE(single.noise);
  EXPECT_FALSE(session.noise) << "the noise of a merged value is not a raw one's";
  EXPECT_EQ(single.reference_exposure_us, 8000.0);
  EXPECT_EQ(SessionRadiometry({}, {500.0}, 3.0).reference_exposure_us, 500.0);
  EXPECT_EQ(SessionRadiometry({}, {500.0}, 3.0).reference_gain_db, 3.0);
}

TEST(ExposureMerge, Refusals) {
  const auto text = [](const std::vector<ExposedImage>& bracket, const calib::Radiometry& r) {
    const auto merged = MergeExposures(bracket, r, {});
    EXPECT_FALSE(merged);
    return merged ? "" : merged.error().text;
  };
  const ExposedImage good{Grey(500), {8000.0, 0.0}};
  EXPECT_THAT(text({}, Raw()), HasSubstr("no picture"));
  EXPECT_THAT(text({good, {Grey(5, 2, 1), {1.0, 0.0}}}, Raw()),
              AllOf(HasSubstr("picture 1"), HasSubstr("2 x 1"), HasSubstr("1 x 1")));
  EXPECT_THAT(text({good, {cv::Mat(1, 1, CV_8U, 5.0), {1.0, 0.0}}}, Raw()), HasSubstr("CV_8UC1"));
  EXPECT_THAT(text({good, {Grey(5), {}}}, Raw()), HasSubstr("no exposure"));
  EXPECT_THAT(text({good, {Grey(5), {0.0, 0.0}}}, Raw()), HasSubstr("above 0 us"));
  calib::Radiometry radiometry = Raw();
  radiometry.encoding = calib::Encoding::kSrgb;
  EXPECT_THAT(text({good, good}, radiometry), HasSubstr("allowed is linear"));
  radiometry = Raw();
  radiometry.reference_exposure_us.reset();
  EXPECT_THAT(text({good, good}, radiometry), HasSubstr("no reference exposure"));
}

}  // namespace
}  // namespace turnlight::rig
