// Proves that each way of getting all poses wrong is told on a lump, that a right capture is not
// accused, and that nothing is claimed where pictures cannot show it. On one scene each;
// consistency_study has many.
#include "estimator/consistency/pose_doubts.h"

#include <gtest/gtest.h>

#include "tests/estimator/consistency/mangled.h"

namespace turnlight::estimator::consistency {
namespace {

Consistency Checked(const Capture& capture, bool all_changes) {
  const target::Geometry geometry(capture.session.target);
  return CheckConsistency(SmallViewsOf(capture, geometry), capture.angles_deg, geometry, {},
                          all_changes, nullptr);
}

class PoseMistake : public testing::TestWithParam<const char*> {};

TEST_P(PoseMistake, IsTold) {
  Capture capture = Captured(SmallCapture(4, Shape::kLump, 18));
  MisplacePoses(capture, GetParam(), 4);
  const Consistency found = Checked(capture, false);
  ASSERT_TRUE(found.change);
  EXPECT_TRUE(NamesMistake(found, GetParam())) << found.change->code << ": " << found.change->words;
  EXPECT_LT(*found.change->rms, 0.006);
}

INSTANTIATE_TEST_SUITE_P(Kinds, PoseMistake, testing::ValuesIn(kPoseMistakes),
                         [](const auto& info) {
                           std::string name = info.param;
                           std::erase_if(name, [](char c) { return std::isalnum(c) == 0; });
                           return name;
                         });

TEST(PoseDoubts, LeaveARightCaptureAlone) {
  const Consistency found = Checked(Captured(SmallCapture(5, Shape::kLump, 18)), true);
  EXPECT_FALSE(found.change);
  EXPECT_EQ(found.frames.odd, 0u);
  EXPECT_GT(found.tried.size(), 10u);
}

TEST(PoseDoubts, ClaimNothingThatPicturesCannotShow) {
  Capture ball = Captured(SmallCapture(5, Shape::kSphere, 18));
  MisplacePoses(ball, "angles-reversed", 5);
  EXPECT_FALSE(Checked(ball, true).change);
}

TEST(PoseDoubts, OfBlackPicturesAreNone) {
  Capture capture = Captured(SmallCapture(5, Shape::kLump, 12));
  for (std::size_t k = 0; k < 12; ++k) MakeOdd(capture, "black", k);
  const Consistency found = Checked(capture, true);
  EXPECT_FALSE(found.comparable);
  EXPECT_FALSE(found.change);
}

TEST(PoseDoubts, OfAFewRightFramesAreNone) {
  for (const int frames : {2, 3, 4}) {
    const Consistency found = Checked(Captured(SmallCapture(5, Shape::kLump, frames)), true);
    EXPECT_TRUE(found.comparable);
    EXPECT_TRUE(found.frames.frames.empty());
    EXPECT_FALSE(found.change) << frames;
  }
}

TEST(PoseDoubts, OfOneFrameAreNone) {
  const Consistency found = Checked(Captured(SmallCapture(5, Shape::kSphere, 1)), true);
  EXPECT_FALSE(found.comparable);
  EXPECT_FALSE(found.change);
  EXPECT_TRUE(found.tried.empty());
}

}  // namespace
}  // namespace turnlight::estimator::consistency
