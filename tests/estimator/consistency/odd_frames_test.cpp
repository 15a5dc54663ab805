// Proves that one odd frame among twelve, of each kind, is named and told from the others on a
// lump and on a ball, that two are, and that lamps that drift and clean captures accuse nobody. On
// a few scenes; consistency_study has many.
#include "estimator/consistency/odd_frames.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/estimator/consistency/mangled.h"

namespace turnlight::estimator::consistency {
namespace {

// level: what the pictures are multiplied by.
FramesJudged Judged(const Capture& capture, double level = 1.0) {
  const target::Geometry geometry(capture.session.target);
  SmallViews views = SmallViewsOf(capture, geometry);
  for (SmallView& view : views.views) view.radiance = view.radiance * level;
  const calib::RayGrid rays(views.camera);
  return JudgeFrames(views, observe::BuildObservations(ToKeyframes(views), geometry, rays),
                     geometry, rays, {}, nullptr);
}

std::vector<std::size_t> OddOf(const FramesJudged& judged) {
  std::vector<std::size_t> out;
  for (std::size_t k = 0; k < judged.frames.size(); ++k)
    if (judged.frames[k].odd) out.push_back(k);
  return out;
}

struct OddKind {
  const char* kind;
  const char* words;  // that its description holds
};

class OddFrame : public testing::TestWithParam<OddKind> {};

TEST_P(OddFrame, IsNamedOnALump) {
  Capture capture = Captured(SmallCapture(4, Shape::kLump, 12));
  MakeOdd(capture, GetParam().kind, 5);
  const FramesJudged judged = Judged(capture);
  ASSERT_EQ(OddOf(judged), std::vector<std::size_t>{5});
  EXPECT_NE(judged.frames[5].what.find(GetParam().words), std::string::npos)
      << judged.frames[5].what;
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, OddFrame,
    testing::Values(OddKind{"black", "is black"},
                    OddKind{"dimmed", "dimmer than the others tell, 0.6 times"},
                    OddKind{"turned", "upside down"}, OddKind{"mirrored", "mirrored left to right"},
                    OddKind{"byte-swapped", "noise"}, OddKind{"stale", "same picture as frame 4"},
                    OddKind{"half", "empty in rows"}, OddKind{"moved", "shifted by about (7, -4)"}),
    [](const auto& info) {
      std::string name = info.param.kind;
      std::erase(name, '-');
      return name;
    });

// Pictures far from white are judged in a unit of their own.
TEST(OddFrames, OfDarkAndBrightPicturesAreTheSame) {
  Capture capture = Captured(SmallCapture(4, Shape::kLump, 12));
  MakeOdd(capture, "dimmed", 5);
  const FramesJudged dark = Judged(capture, std::exp2(-12.0));
  const FramesJudged bright = Judged(capture, std::exp2(12.0));
  const double factor = std::exp2(24.0);
  ASSERT_EQ(OddOf(dark), std::vector<std::size_t>{5});
  ASSERT_EQ(OddOf(bright), std::vector<std::size_t>{5});
  EXPECT_EQ(bright.frames[5].what, dark.frames[5].what);
  EXPECT_EQ(bright.rms_of_all, factor * dark.rms_of_all);
  EXPECT_EQ(bright.rms_of_rest, factor * dark.rms_of_rest);
  EXPECT_EQ(bright.usual, factor * dark.usual);
  EXPECT_EQ(bright.level, factor * dark.level);
  EXPECT_EQ(bright.noise, factor * dark.noise);
  for (std::size_t k = 0; k < 12; ++k) {
    EXPECT_EQ(bright.frames[k].residual.gain, dark.frames[k].residual.gain);
    EXPECT_EQ(bright.frames[k].residual.left, factor * dark.frames[k].residual.left);
  }
}

TEST(OddFrames, OnABallAreNamedWhereTheyShow) {
  Capture capture = Captured(SmallCapture(5, Shape::kSphere, 12));
  MakeOdd(capture, "stale", 3);  // every frame of a turning ball is the same
  EXPECT_TRUE(OddOf(Judged(capture)).empty());
  MakeOdd(capture, "turned", 8);
  EXPECT_EQ(OddOf(Judged(capture)), std::vector<std::size_t>{8});
}

TEST(OddFrames, TwoOfTwelveAreNamed) {
  Capture capture = Captured(SmallCapture(6, Shape::kLump, 12));
  MakeOdd(capture, "black", 2);
  MakeOdd(capture, "moved", 9);
  EXPECT_EQ(OddOf(Judged(capture)), (std::vector<std::size_t>{2, 9}));
}

TEST(OddFrames, AMaskOfAnotherFrameIsNamed) {
  Capture capture = Captured(SmallCapture(7, Shape::kLump, 12));
  GiveMasks(capture);
  EXPECT_TRUE(OddOf(Judged(capture)).empty());
  MakeOdd(capture, "wrong-mask", 4);
  const FramesJudged judged = Judged(capture);
  ASSERT_EQ(OddOf(judged), std::vector<std::size_t>{4});
  EXPECT_NE(judged.frames[4].what.find("mask"), std::string::npos) << judged.frames[4].what;
}

TEST(OddFrames, AFrameWithoutAMaskIsNotOddForThat) {
  Capture capture = Captured(SmallCapture(7, Shape::kLump, 12));
  GiveMasks(capture);
  capture.session.frames[6].mask.setTo(255);
  EXPECT_TRUE(OddOf(Judged(capture)).empty());
}

// A mask made from a dim picture is smaller: that is no fault of the mask.
TEST(OddFrames, ADimFrameAmongMasksOfPicturesIsDim) {
  Capture capture = Captured(SmallCapture(7, Shape::kLump, 12));
  MakeOdd(capture, "dimmed", 5);
  GiveMasks(capture);
  const FramesJudged judged = Judged(capture);
  ASSERT_EQ(OddOf(judged), std::vector<std::size_t>{5});
  EXPECT_NE(judged.frames[5].what.find("dimmer"), std::string::npos) << judged.frames[5].what;
}

TEST(OddFrames, ALampThatDriftsAccusesNobody) {
  for (const bool at_random : {false, true}) {
    Capture capture = Captured(SmallCapture(8, Shape::kLump, 12));
    LetLampDrift(capture, 0.05, at_random, 8);
    const FramesJudged judged = Judged(capture);
    EXPECT_TRUE(OddOf(judged).empty());
    EXPECT_NE(judged.frames[0].residual.gain, judged.frames[11].residual.gain);
  }
}

TEST(OddFrames, ManyAreNoneOfThem) {
  Capture capture = Captured(SmallCapture(9, Shape::kLump, 12));
  for (std::size_t k = 0; k < 6; ++k) MakeOdd(capture, "turned", 2 * k);
  EXPECT_TRUE(OddOf(Judged(capture)).empty());
}

}  // namespace
}  // namespace turnlight::estimator::consistency
