// Proves: angles of a plan are the decimal numbers that a person would write, in order; every move
// ends from the same side; durations and sizes follow from the numbers given; every bad plan is
// refused by key and value. Does not prove: that a table moves so (rig/sim and drivers).
#include "rig/capture/capture_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "rig/session/image_file.h"

namespace turnlight::rig {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

Result<CapturePlan> Parse(const std::string& text) {
  const auto document = ParseYaml(text, "c.yaml");
  if (!document) return Forward(document);
  return ParseCapturePlan(StrictObject(*document));
}

std::string Refusal(const std::string& text) {
  const auto plan = Parse(text);
  EXPECT_FALSE(plan) << text;
  return plan ? "" : plan.error().text;
}

std::vector<double> Angles(const CapturePlan& plan) {
  std::vector<double> angles;
  for (const PlannedFrame& frame : PlannedFrames(plan)) angles.push_back(frame.angle_deg);
  return angles;
}

TEST(CapturePlan, DefaultIsATurnInTens) {
  const auto plan = Parse("{}");
  ASSERT_TRUE(plan) << plan.error().text;
  const auto frames = PlannedFrames(*plan);
  ASSERT_EQ(frames.size(), 36u);
  for (std::size_t i = 0; i < 36; ++i) {
    EXPECT_EQ(frames[i].index, i);
    EXPECT_EQ(frames[i].angle_deg, 10.0 * static_cast<double>(i));
    EXPECT_FALSE(frames[i].closure);
  }
}

TEST(CapturePlan, EveryKeyIsRead) {
  const auto plan = Parse(
      "start_deg: -5.5\nstep_deg: 2.5\ncount: 4\ndirection: cw\napproach: direct\n"
      "backlash_deg: 1\nsettle_ms: 30\nexposures_us: [8000, 500.5]\ngain_db: 3\nretries: 0\n"
      "closure: true\ntolerance_deg: 0.01\nmove_timeout_s: 9\nframe_timeout_s: 8\n"
      "limits_deg: [-400, 400]\n");
  ASSERT_TRUE(plan) << plan.error().text;
  EXPECT_THAT(Angles(*plan), ElementsAre(-5.5, -8.0, -10.5, -13.0, -365.5));
  EXPECT_TRUE(PlannedFrames(*plan).back().closure);
  EXPECT_EQ(PlannedFrames(*plan).back().index, 4u);
  EXPECT_EQ(plan->approach, Approach::kDirect);
  EXPECT_EQ(plan->backlash_deg, 1.0);
  EXPECT_EQ(plan->settle_ms, 30.0);
  EXPECT_THAT(plan->exposures_us, ElementsAre(8000.0, 500.5));
  EXPECT_EQ(plan->gain_db, 3.0);
  EXPECT_EQ(plan->retries, 0);
  EXPECT_EQ(plan->tolerance_deg, 0.01);
  EXPECT_EQ(plan->move_timeout_s, 9.0);
  EXPECT_EQ(plan->frame_timeout_s, 8.0);
  EXPECT_EQ(plan->limits->min_deg, -400.0);
  EXPECT_EQ(plan->limits->max_deg, 400.0);
}

TEST(CapturePlan, ByHandThereAreNoAngles) {
  const auto parse = [](const std::string& text) {
    const auto document = ParseYaml(text, "c.yaml");
    return ParsePlanByHand(StrictObject(*document));
  };
  const auto plan = parse("{count: 3, step_deg: 8, exposures_us: [500], gain_db: 1, retries: 2}");
  ASSERT_TRUE(plan) << plan.error().text;
  EXPECT_THAT(Angles(*plan), ElementsAre(0.0, 0.0, 0.0));
  EXPECT_EQ(Label(PlannedFrames(*plan)[2]), "frame 2");
  const PlanEstimate estimate = EstimatePlan(*plan, {}, {{64, 48}, 3, CV_16U});
  EXPECT_EQ(estimate.frames, 3u);
  EXPECT_EQ(estimate.travel_deg, 0.0);
  EXPECT_THAT(parse("{settle_ms: 1}").error().text, HasSubstr("settle_ms"));
  EXPECT_THAT(parse("{step_deg: 200}").error().text, HasSubstr("at most 180"));
  EXPECT_THAT(parse("{exposures_us: [500, 900]}").error().text,
              HasSubstr("2 exposures, allowed is one"));
}

TEST(CapturePlan, AnglesAreExactDecimals) {
  CapturePlan plan;
  plan.step_deg = 0.1;
  plan.count = 3600;
  plan.closure = true;
  plan.tolerance_deg = 0.01;
  ASSERT_FALSE(Validate(plan));
  const auto frames = PlannedFrames(plan);
  EXPECT_EQ(frames[3].angle_deg, 0.3);  // 3 * 0.1 and 0.1 + 0.1 + 0.1 are not
  for (const PlannedFrame& frame : frames)
    EXPECT_EQ(frame.angle_deg,
              std::stod(std::to_string(frame.index / 10) + "." + std::to_string(frame.index % 10)));
  EXPECT_EQ(frames.back().angle_deg, 360.0);
  plan.step_deg = 0.000001;
  plan.tolerance_deg = 0.0000001;
  EXPECT_FALSE(Validate(plan));
  EXPECT_EQ(PlannedFrames(plan)[7].angle_deg, 0.000007);
}

TEST(CapturePlan, ClosureIsTheNextWholeTurn) {
  CapturePlan plan;
  plan.closure = true;
  EXPECT_EQ(Angles(plan).back(), 360.0);
  plan.direction = TurnDirection::kCw;
  EXPECT_EQ(Angles(plan).back(), -360.0);
  plan.start_deg = 15.0;
  EXPECT_EQ(Angles(plan).back(), -345.0);
  plan.count = 1;
  EXPECT_THAT(Angles(plan), ElementsAre(15.0, -345.0));
  plan = {};
  plan.count = 50;
  plan.closure = true;
  EXPECT_EQ(Angles(plan).back(), 720.0);
}

TEST(CapturePlan, LastLegAlwaysComesFromTheSameSide) {
  CapturePlan plan;
  EXPECT_THAT(MoveLegs(plan, std::nullopt, 0.0), ElementsAre(-2.0, 0.0));
  EXPECT_THAT(MoveLegs(plan, 0.0, 10.0), ElementsAre(10.0));
  EXPECT_THAT(MoveLegs(plan, 8.0, 10.0), ElementsAre(10.0));
  EXPECT_THAT(MoveLegs(plan, 8.5, 10.0), ElementsAre(8.0, 10.0));
  EXPECT_THAT(MoveLegs(plan, 10.0, 10.0), ElementsAre(8.0, 10.0));
  EXPECT_THAT(MoveLegs(plan, 350.0, 10.0), ElementsAre(8.0, 10.0));
  plan.direction = TurnDirection::kCw;
  EXPECT_THAT(MoveLegs(plan, std::nullopt, 0.0), ElementsAre(2.0, 0.0));
  EXPECT_THAT(MoveLegs(plan, 0.0, -10.0), ElementsAre(-10.0));
  EXPECT_THAT(MoveLegs(plan, -10.0, -5.0), ElementsAre(-3.0, -5.0));
  plan.approach = Approach::kDirect;
  EXPECT_THAT(MoveLegs(plan, -10.0, -5.0), ElementsAre(-5.0));
}

TEST(CapturePlan, MovesTakeWhatPhysicsSays) {
  const TableKinematics table{20.0, 100.0};  // full speed after 0.2 s and 2 degrees
  EXPECT_DOUBLE_EQ(MoveSeconds(table, 0.0), 0.0);
  EXPECT_DOUBLE_EQ(MoveSeconds(table, 1.0), 0.2);  // 0.5 degrees in each of two 0.1 s
  EXPECT_DOUBLE_EQ(MoveSeconds(table, 4.0), 0.4);
  EXPECT_DOUBLE_EQ(MoveSeconds(table, -10.0), 0.7);
}

TEST(CapturePlan, EstimateAddsUp) {
  CapturePlan plan;
  plan.closure = true;
  plan.exposures_us = {10000.0, 30000.0};
  const PictureFormat format{{100, 50}, 3, CV_16U};
  const auto estimate = EstimatePlan(plan, {20.0, 100.0}, format, 0.08);
  EXPECT_EQ(estimate.frames, 37u);
  EXPECT_EQ(estimate.exposures, 74u);
  EXPECT_DOUBLE_EQ(estimate.travel_deg, 364.0);
  EXPECT_NEAR(estimate.seconds, 2.0 * 2.0 * std::sqrt(0.02) + 36 * 0.7 + 37 * (0.2 + 0.2), 1e-9);
  EXPECT_EQ(estimate.range.min_deg, -2.0);
  EXPECT_EQ(estimate.range.max_deg, 360.0);
  EXPECT_GT(estimate.bytes, 37u * (100 * 50 * 13));
}

TEST(CapturePlan, BytesHoldForNoise) {
  cv::Mat noise(48, 64, CV_16UC3);
  cv::RNG(3).fill(noise, cv::RNG::UNIFORM, 0, 65536);
  const auto png = EncodeImage("a.png", noise);
  ASSERT_TRUE(png);
  CapturePlan plan;
  EXPECT_GE(EstimatePlan(plan, {}, {noise.size(), 3, CV_16U}).bytes_per_frame, png->size());
  cv::Mat floats;
  noise.convertTo(floats, CV_32F, 1.0 / 7.0);
  const auto exr = EncodeImage("a.exr", floats);
  ASSERT_TRUE(exr);
  plan.exposures_us.push_back(1.0);
  EXPECT_GE(EstimatePlan(plan, {}, {noise.size(), 3, CV_16U}).bytes_per_frame, exr->size());
}

TEST(CapturePlan, RefusalsNameLineKeyAndValue) {
  EXPECT_THAT(Refusal("count: 36\nstep_deg: 0"),
              AllOf(HasSubstr("c.yaml:2: step_deg: 0"), HasSubstr("above 0, at most 360")));
  EXPECT_THAT(Refusal("step_deg: 361"), HasSubstr("step_deg: 361"));
  EXPECT_THAT(Refusal("step_deg: .nan"), HasSubstr("step_deg"));
  EXPECT_THAT(Refusal("step_deg: 51.4285714"),
              AllOf(HasSubstr("51.4285714"), HasSubstr("at most 6 decimal places")));
  EXPECT_THAT(Refusal("start_deg: 1e9"), HasSubstr("start_deg: 1000000000"));
  EXPECT_THAT(Refusal("count: 0"), HasSubstr("a whole number from 1 to 100000"));
  EXPECT_THAT(Refusal("count: 3.5"), HasSubstr("count: 3.5"));
  EXPECT_THAT(Refusal("direction: left"), HasSubstr("one of ccw, cw"));
  EXPECT_THAT(Refusal("approach: both"), HasSubstr("one of one-sided, direct"));
  EXPECT_THAT(Refusal("backlash_deg: -1"), HasSubstr("backlash_deg: -1"));
  EXPECT_THAT(Refusal("settle_ms: -1"), HasSubstr("settle_ms: -1"));
  EXPECT_THAT(Refusal("exposures_us: []"), HasSubstr("a list of 1 to 16"));
  EXPECT_THAT(Refusal("exposures_us: 8000"), HasSubstr("a list of 1 to 16"));
  EXPECT_THAT(Refusal("exposures_us: [0]"), HasSubstr("from 0.1"));
  EXPECT_THAT(Refusal("exposures_us: [100, 200, 100]"), HasSubstr("100 appears twice"));
  EXPECT_THAT(Refusal("gain_db: 100"), HasSubstr("gain_db: 100"));
  EXPECT_THAT(Refusal("retries: -1"), HasSubstr("retries: -1"));
  EXPECT_THAT(Refusal("tolerance_deg: 0"), HasSubstr("tolerance_deg: 0"));
  EXPECT_THAT(Refusal("step_deg: 0.1\ntolerance_deg: 0.05"),
              AllOf(HasSubstr("tolerance_deg: 0.05"), HasSubstr("half of step_deg, 0.1")));
  EXPECT_THAT(Refusal("move_timeout_s: 0"), HasSubstr("move_timeout_s: 0"));
  EXPECT_THAT(Refusal("frame_timeout_s: 4000"), HasSubstr("frame_timeout_s: 4000"));
  EXPECT_THAT(Refusal("count: 37\nclosure: true"),
              AllOf(HasSubstr("closure: true"), HasSubstr("37 keyframes"), HasSubstr("360 deg")));
  EXPECT_THAT(Refusal("limits_deg: [0, 360]"),
              AllOf(HasSubstr("from -2 to 350"), HasSubstr("0 to 360")));
  EXPECT_THAT(Refusal("limits_deg: [5, 5]"), HasSubstr("lower end below"));
  EXPECT_THAT(Refusal("setle_ms: 3"), HasSubstr("setle_ms"));
}

TEST(CapturePlan, UntilIsReadAndRefusedByKey) {
  const auto plan = Parse("until: {direction_deg: 0.05}\n");
  ASSERT_TRUE(plan) << plan.error().text;
  EXPECT_EQ(plan->until->direction_deg, 0.05);
  EXPECT_EQ(plan->until->most_extra, 12);
  EXPECT_FALSE(Parse("{}")->until.has_value());
  EXPECT_THAT(Refusal("until: {direction_deg: 50}\n"), HasSubstr("direction_deg"));
  EXPECT_THAT(Refusal("until: {}\n"), HasSubstr("direction_deg"));
  EXPECT_THAT(Refusal("until: {direction_deg: 1, most_extra: 1001}\n"), HasSubstr("most_extra"));
  EXPECT_THAT(Refusal("until: {direction_deg: 1}\nclosure: true\n"), HasSubstr("closure"));
  CapturePlan wrong;
  wrong.until = UntilDirections{0.0, 1};
  EXPECT_EQ(Validate(wrong)->key, "until/direction_deg");
}

TEST(CapturePlan, ExtraAnglesAreBetweenAndBeyondThoseThatAreTaken) {
  CapturePlan plan;
  plan.step_deg = 90.0;
  plan.count = 2;
  EXPECT_THAT(ExtraAngles(plan, {0.0, 90.0}),
              ElementsAre(22.5, 45.0, 67.5, 112.5, 135.0, 157.5, 180.0, 202.5, 225.0, 247.5, 270.0,
                          292.5, 315.0, 337.5));
  plan.limits = AngleLimits{-5.0, 120.0};
  EXPECT_THAT(ExtraAngles(plan, {0.0, 90.0, 405.0}), ElementsAre(22.5, 67.5, 112.5))
      << "405 is 45, a turn later";
  plan.direction = TurnDirection::kCw;
  plan.limits.reset();
  EXPECT_EQ(ExtraAngles(plan, {0.0, -90.0}).front(), -22.5);
  plan.step_deg = 1.0;
  EXPECT_EQ(ExtraAngles(plan, {}).size(), kMostExtraAngles);
}

}  // namespace
}  // namespace turnlight::rig
