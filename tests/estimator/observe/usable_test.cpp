// Proves: flags are counted by pixels of the target; what is not enough for an estimate is refused
// in words that name the numbers and say what to do, and what is just enough is not. Does not prove
// that the advice helps.
#include "estimator/observe/usable.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "estimator/observe/keyframe_tracer.h"
#include "tests/estimator/random_observations.h"

namespace turnlight::estimator::observe {
namespace {

using testing::HasSubstr;

std::string RefusalOf(const Status& status) {
  EXPECT_FALSE(status);
  if (status) return {};
  EXPECT_EQ(status.error().kind, ErrorKind::kNoEstimate);
  EXPECT_THAT(status.error().text, HasSubstr("no usable estimate: "));
  return status.error().text;
}

TEST(CountFlags, CountsPixelsOfTheTargetByKind) {
  const cv::Mat1b first = (cv::Mat1b(1, 4) << kOffTarget, kOffTarget | kSaturated, 0, kSaturated);
  const cv::Mat1b second = (cv::Mat1b(1, 4) << kSilhouette, kGrazing | kSilhouette, kUnlikeOthers,
                            kLostInNoise | kSaturated);
  const FlagCounts counts = CountFlags({first, second});
  EXPECT_EQ(counts.on_target, 6u);
  EXPECT_EQ(counts.saturated, 2u);
  EXPECT_EQ(counts.edge, 2u);
  EXPECT_EQ(counts.outliers, 1u);
  EXPECT_EQ(counts.lost, 1u);
}

TEST(CheckUsable, ThirtyLitPixelsAreEnough) {
  EXPECT_TRUE(CheckUsable(RandomObservations(30, 3, 1).observations));
  EXPECT_THAT(RefusalOf(CheckUsable(RandomObservations(29, 3, 1).observations)),
              HasSubstr("29 usable pixels so far, at least 30 are needed: the next pictures"));
}

TEST(CheckUsable, SaysWhyTheOthersAreNot) {
  const Observations few = RandomObservations(10, 3, 1).observations;
  const auto why = [&](const FlagCounts& counts) { return RefusalOf(CheckUsable(few, &counts)); };
  EXPECT_THAT(why({}), HasSubstr("The masks leave no pixel"));
  EXPECT_THAT(why({.in_masks = 1}), HasSubstr("No pixel shows the target: check the poses"));
  EXPECT_THAT(why({.on_target = 100, .edge = 90, .oblique = 90, .from_behind = 0.6}),
              HasSubstr("60 % of what is seen of the target is seen from behind"));
  EXPECT_THAT(why({.on_target = 100, .saturated = 60, .not_numbers = 60}),
              HasSubstr("60 of 100 target pixels are no numbers"));
  EXPECT_THAT(why({.on_target = 100, .saturated = 51, .edge = 49}),
              HasSubstr("51 of 100 target pixels are clipped: lower the exposure"));
  EXPECT_THAT(why({.on_target = 100, .saturated = 60, .above = 31}),
              HasSubstr("60 of 100 target pixels lie above radiometry's saturation"));
  EXPECT_THAT(why({.on_target = 100, .saturated = 50, .lost = 60, .bright = 0.1}),
              HasSubstr("60 of 100 target pixels are lost in noise; bright ones reach 0.1 of"));
  EXPECT_THAT(why({.on_target = 100, .saturated = 50, .lost = 60, .bright = 0.5}),
              HasSubstr("lost in noise, though bright ones reach 0.5 of white: lower the gain"));
  EXPECT_THAT(why({.on_target = 100, .saturated = 20, .edge = 70}),
              HasSubstr("70 of 100 target pixels are at the outline"));
  EXPECT_THAT(why({.on_target = 100, .saturated = 20, .edge = 70, .oblique = 40}),
              HasSubstr("70 of 100 target pixels see the surface too obliquely"));
  EXPECT_THAT(why({.on_target = 100, .saturated = 40, .lost = 30, .edge = 20}),
              HasSubstr("Of 100 target pixels 40 are clipped, 30 lost in noise, 20 at the"));
  EXPECT_THAT(why({.on_target = 100, .saturated = 40}), HasSubstr("a shorter exposure against"));
}

model::Keyframe Strip(const std::vector<float>& values, const std::vector<int>& clipped) {
  model::Keyframe keyframe;
  const int width = static_cast<int>(values.size());
  keyframe.image.radiance = cv::Mat1f(values, true).reshape(1, 1);
  keyframe.image.saturated = cv::Mat1b::zeros(1, width);
  for (const int column : clipped) keyframe.image.saturated(0, column) = 255;
  keyframe.mask = cv::Mat1b(1, width, std::uint8_t{255});
  return keyframe;
}

TEST(CountValues, TellsClippingFromASettingAndFromWhatIsNoNumber) {
  FlagCounts counts;
  const cv::Mat1b flags = (cv::Mat1b(1, 5) << 0, 0, 0, 0, kOffTarget);
  CountValues(Strip({0.5f, 1.0f, 0.99f, 1.0f, 9.0f}, {1, 2, 3, 4}), flags, counts);
  EXPECT_EQ(counts.in_masks, 5u);
  EXPECT_EQ(counts.above, 0u);
  EXPECT_EQ(counts.not_numbers, 0u);
  EXPECT_NEAR(counts.bright, 1.0, 1e-6);
  CountValues(Strip({0.5f, 0.6f, 0.7f, 1.0f, 9.0f}, {0, 1, 2, 3}), flags, counts);
  EXPECT_EQ(counts.above, 3u);
  CountValues(Strip({0.0f, 0.0f, 0.2f, 0.3f, 9.0f}, {0, 1}), flags, counts);
  EXPECT_EQ(counts.not_numbers, 2u);
  EXPECT_EQ(counts.above, 3u);
}

TEST(CheckUsable, BlackPicturesAreRefused) {
  Observations all = RandomObservations(2000, 3, 1).observations;
  for (int c = 0; c < 3; ++c) all.radiance[c].assign(all.size(), 1e-8f);
  all.radiance[0][17] = 0.5f;  // one of 2000 is no light
  EXPECT_THAT(RefusalOf(CheckUsable(all)),
              HasSubstr("every usable pixel is black (99.9 % at or below 1e-08 of white)"));
  all.radiance[0].assign(all.size(), 1e-6f);
  EXPECT_TRUE(CheckUsable(all));
}

TEST(CheckOutliers, MoreThanAThirdIsNoSurface) {
  EXPECT_TRUE(CheckOutliers({.on_target = 100, .outliers = 35}));
  EXPECT_THAT(RefusalOf(CheckOutliers({.on_target = 100, .outliers = 36})),
              HasSubstr("36 of 100 target pixels are unlike all around them"));
  EXPECT_FALSE(ManyOutliers({.on_target = 1000, .outliers = 5}));
  EXPECT_TRUE(ManyOutliers({.on_target = 1000, .outliers = 6}));
}

}  // namespace
}  // namespace turnlight::estimator::observe
