// Proves that small pictures are the means of blocks, that what is clipped or masked in a block
// marks all of it, and that the lens of the small pictures sends the same rays through the middles
// of blocks. Not that a few thousand pixels are enough: odd_frames_test and pose_doubts_test.
#include "estimator/consistency/small_views.h"

#include <gtest/gtest.h>

#include <limits>

namespace turnlight::estimator::consistency {
namespace {

model::Keyframe Ramp() {
  cv::Mat3f image(5, 7);
  for (int row = 0; row < 5; ++row)
    for (int column = 0; column < 7; ++column)
      image(row, column) = {static_cast<float>(row), static_cast<float>(column), 3.0f};
  model::Keyframe out;
  out.image.radiance = image;
  out.image.saturated = cv::Mat1b(5, 7, std::uint8_t{0});
  out.mask = cv::Mat1b(5, 7, std::uint8_t{255});
  return out;
}

TEST(SmallViews, AreTheMeansOfBlocksAndOfColours) {
  const SmallView small = MakeSmallView(Ramp(), 2, 0);
  ASSERT_EQ(small.radiance.size(), cv::Size(3, 2));
  EXPECT_FLOAT_EQ(small.radiance(0, 0), (0.5f + 0.5f + 3.0f) / 3.0f);
  EXPECT_FLOAT_EQ(small.radiance(1, 2), (2.5f + 4.5f + 3.0f) / 3.0f);
}

TEST(SmallViews, MarkABlockByAnyOfItsPixels) {
  model::Keyframe keyframe = Ramp();
  keyframe.image.saturated(1, 1) = 255;
  keyframe.mask(3, 5) = 0;
  cv::Mat3f image = keyframe.image.radiance;
  image(2, 0)[1] = std::numeric_limits<float>::quiet_NaN();
  const SmallView small = MakeSmallView(keyframe, 2, 0);
  EXPECT_EQ(small.clipped(0, 0), 255);
  EXPECT_EQ(small.clipped(0, 1), 0);
  EXPECT_EQ(small.clipped(1, 0), 255);
  EXPECT_EQ(small.radiance(1, 0), 0.0f);
  EXPECT_EQ(small.mask(1, 2), 0);
  EXPECT_EQ(small.mask(1, 1), 255);
}

TEST(SmallViews, TheLensOfBlocksSeesTheSameDirections) {
  const auto camera = calib::CameraModel::Pinhole(64, 48, 80.0, 81.0, 31.2, 23.9);
  const auto small = camera.InBlocks(4);
  EXPECT_EQ(small.width(), 16);
  EXPECT_EQ(small.height(), 12);
  // The middle of block (3, 2) lies between pixels 13 and 14, 9 and 10.
  const auto in_small = small.Unproject({{3.0, 2.0}})[0];
  const auto in_large = camera.Unproject({{13.5, 9.5}})[0];
  EXPECT_LT((in_small - in_large).norm(), 1e-12);
}

TEST(SmallViews, LeaveAFewThousandPixelsOnATargetOfAnySize) {
  const target::Geometry ball(calib::SphereShape{50.0});
  const auto poses = std::vector<calib::RigPoses>{{calib::LookAtOrigin(0.0, 0.5, 500.0), {}}};
  const auto block = [&](int width) {
    const auto camera =
        calib::CameraModel::Pinhole(width, width, width, width, 0.5 * width, 0.5 * width);
    return BlockFor(camera, ball, poses);
  };
  EXPECT_EQ(block(200), 1);
  // A ball of 600 pixels across, 283 000 in all.
  EXPECT_EQ(block(3000), 10);
  const auto behind =
      std::vector<calib::RigPoses>{{calib::LookAtOrigin(0.0, 0.5, 500.0).Inverse(), {}}};
  EXPECT_GE(BlockFor(calib::CameraModel::Pinhole(300, 300, 300, 300, 150, 150), ball, behind), 1);
}

}  // namespace
}  // namespace turnlight::estimator::consistency
