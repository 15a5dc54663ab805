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
              HasSubstr("29 usable pixels, at least 30 are needed"));
}

TEST(CheckUsable, SaysWhyTheOthersAreNot) {
  const Observations few = RandomObservations(10, 3, 1).observations;
  const auto why = [&](const FlagCounts& counts) { return RefusalOf(CheckUsable(few, &counts)); };
  EXPECT_THAT(why({}), HasSubstr("No pixel shows the target: check the poses"));
  EXPECT_THAT(why({.on_target = 100, .edge = 90, .rays = 50, .from_behind = 26}),
              HasSubstr("its winding is inside out"));
  EXPECT_THAT(why({.on_target = 100, .saturated = 51, .edge = 49}),
              HasSubstr("51 of 100 target pixels are clipped: lower the exposure"));
  EXPECT_THAT(why({.on_target = 100, .saturated = 50, .lost = 60}),
              HasSubstr("60 of 100 target pixels are lost in noise: expose longer"));
  EXPECT_THAT(why({.on_target = 100, .saturated = 20, .edge = 70}),
              HasSubstr("70 of 100 target pixels are at the outline or too oblique"));
}

TEST(CheckUsable, BlackPicturesAreRefused) {
  Observations all = RandomObservations(2000, 3, 1).observations;
  for (int c = 0; c < 3; ++c) all.radiance[c].assign(all.size(), 1e-8f);
  all.radiance[0][17] = 0.5f;  // one of 2000 is no light
  EXPECT_THAT(RefusalOf(CheckUsable(all)), HasSubstr("every usable pixel is black"));
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
