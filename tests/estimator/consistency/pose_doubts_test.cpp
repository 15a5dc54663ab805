// Proves that each way of getting all poses wrong is told on a lump, that a right capture is not
// accused, and that nothing is claimed where pictures cannot show it. On one scene each;
// consistency_study has many.
#include "estimator/consistency/pose_doubts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "estimator/consistency/explanation.h"
#include "tests/estimator/consistency/mangled.h"

namespace turnlight::estimator::consistency {
namespace {

Consistency Checked(const Capture& capture, bool all_changes, const StopFlag* stop = nullptr) {
  const target::Geometry geometry(capture.session.target);
  return CheckConsistency(SmallViewsOf(capture, geometry), capture.angles_deg, geometry, {},
                          all_changes, stop);
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

struct ScaleMistake {
  const char* mistake;
  double factor;  // that mends it
};

class FactorOfAngles : public testing::TestWithParam<ScaleMistake> {};

TEST_P(FactorOfAngles, IsToldWithin06Percent) {
  Capture capture = Captured(SmallCapture(4, Shape::kLump, 18));
  MisplacePoses(capture, GetParam().mistake, 4);
  const Consistency found = Checked(capture, false);
  ASSERT_TRUE(found.change);
  ASSERT_EQ(found.change->code, "angle-factor");
  const double truth = GetParam().factor;
  EXPECT_NEAR(found.change->factor, truth, 0.006 * truth);
  const std::string& words = found.change->words;
  EXPECT_NEAR(std::stod(words.substr(words.rfind(' '))), truth, 0.006 * truth) << words;
}

INSTANTIATE_TEST_SUITE_P(Kinds, FactorOfAngles,
                         testing::Values(ScaleMistake{"factor 2", 0.5},
                                         ScaleMistake{"factor 0.98", 1.0 / 0.98}),
                         [](const auto& info) {
                           return std::string(info.index == 0 ? "Twice" : "ALittleLess");
                         });

// What stands behind the target is brighter than it and another thing in every picture.
class MistakeBeforeClutter : public testing::TestWithParam<const char*> {};

TEST_P(MistakeBeforeClutter, IsToldWithMasks) {
  Capture capture = Captured(SmallCapture(4, Shape::kLump, 18));
  GiveOutlines(capture);
  ClutterBackground(capture, 4);
  MisplacePoses(capture, GetParam(), 4);
  const Consistency found = Checked(capture, false);
  ASSERT_TRUE(found.change);
  EXPECT_TRUE(NamesMistake(found, GetParam())) << found.change->code << ": " << found.change->words;
}

INSTANTIATE_TEST_SUITE_P(Kinds, MistakeBeforeClutter,
                         testing::Values("angles-reversed", "order-shuffled", "camera-inverted",
                                         "camera-axes", "length-unit"),
                         [](const auto& info) {
                           std::string name = info.param;
                           std::erase(name, '-');
                           return name;
                         });

// The camera looks away from the target, and what it shows is a bright square: a part of it can be
// explained by any light with the target before it.
TEST(PoseDoubts, ClaimNothingWithoutAnOutlineIfNothingIsSeen) {
  Capture capture = Captured(SmallCapture(4, Shape::kLump, 18));
  for (auto& frame : capture.session.frames) {
    frame.image.setTo(0);
    frame.image(cv::Rect(22, 7, 76, 76)).setTo(cv::Scalar::all(20000));
  }
  MisplacePoses(capture, "camera-axes", 4);
  const Consistency found = Checked(capture, false);
  EXPECT_FALSE(found.seen);
  ASSERT_FALSE(found.tried.empty());
  EXPECT_TRUE(std::any_of(found.tried.begin(), found.tried.end(), [](const TriedChange& tried) {
    return tried.rms && *tried.rms < 0.006;
  }));
  EXPECT_FALSE(found.change) << found.change->words;
}

TEST(Explainer, TellsHowMuchOfTheTargetIsInTheMasks) {
  Capture capture = Captured(SmallCapture(4, Shape::kLump, 6));
  const target::Geometry geometry(capture.session.target);
  const auto share = [&] {
    const SmallViews views = SmallViewsOf(capture, geometry);
    const calib::RayGrid rays(views.camera);
    const Explainer explainer(views, geometry, rays, nullptr);
    return explainer.ShareInMasks(explainer.DesignOf(PosesOf(views)), InOrder(views));
  };
  EXPECT_EQ(share(), 1.0);
  GiveOutlines(capture);
  EXPECT_GT(share(), 0.9);
  for (auto& frame : capture.session.frames) frame.mask.colRange(0, 60).setTo(0);
  EXPECT_NEAR(share(), 0.5, 0.1);
  MisplacePoses(capture, "camera-axes", 4);
  EXPECT_EQ(share(), 0.0);
}

// Told at once, while frames are judged, and while changes are searched.
TEST(PoseDoubts, EndSoonWhenTheyAreToldTo) {
  using Clock = std::chrono::steady_clock;
  Capture capture = Captured(SmallCapture(4, Shape::kLump, 12));
  MisplacePoses(capture, "order-shuffled", 4);
  const auto begin = Clock::now();
  const Consistency whole = Checked(capture, true);
  const auto whole_time = Clock::now() - begin;
  ASSERT_TRUE(whole.change);
  for (const int eighths : {0, 3, 7}) {
    StopFlag stop(eighths == 0);
    auto told = Clock::now();
    std::thread other([&] {
      std::this_thread::sleep_for(whole_time * eighths / 8);
      told = Clock::now();
      stop = true;
    });
    const Consistency some = Checked(capture, true, &stop);
    const auto ended = Clock::now();
    other.join();
    EXPECT_LT(ended, told + whole_time / 4 + std::chrono::seconds(1)) << eighths;
    EXPECT_LE(some.tried.size(), eighths == 0 ? 0 : whole.tried.size());
    if (some.change) {
      EXPECT_EQ(some.change->code, whole.change->code);
    }
  }
}

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
