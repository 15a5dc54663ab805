// Proves: two captures of one scene are the same in every one of many seeds; a frame at a wrong
// angle (0.1 degree), another brightness (1 %), and each other thing that is not the same are found
// and named; a session that is not good is refused. Pictures alone: picture_difference_test.
#include "rig/session/compare_sessions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <functional>

#include "tests/rig/session/rendered_table.h"
#include "tests/temporary_folder.h"

namespace turnlight::rig {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

constexpr int kFrames = 4;

const sim::SyntheticSession& Rendered() {
  static const sim::SyntheticSession rendered = RenderTable(kFrames);
  return rendered;
}

std::vector<std::string> DifferentIn(const Comparison& comparison) {
  std::vector<std::string> names;
  for (const ComparedQuantity& quantity : comparison.quantities)
    if (quantity.verdict == Verdict::kDifferent)
      names.push_back(quantity.group + ": " + quantity.name);
  return names;
}

Comparison ComparedSessions(const std::filesystem::path& a, const std::filesystem::path& b) {
  const auto comparison = CompareSessions(a, b, StandardTolerances(SessionQuantities()));
  EXPECT_TRUE(comparison) << (comparison ? "" : comparison.error().text);
  return comparison.value_or(Comparison());
}

TEST(CompareSessions, OtherNoiseIsTheSameInEverySeed) {
  const TemporaryFolder folder;
  RecordTable(Rendered(), 1, folder.path() / "reference");
  for (std::uint64_t seed = 2; seed <= 13; ++seed) {
    const std::filesystem::path other = folder.path() / "other";
    RecordTable(Rendered(), seed, other);
    EXPECT_THAT(DifferentIn(ComparedSessions(folder.path() / "reference", other)), ElementsAre())
        << seed;
  }
}

TEST(CompareSessions, TheSameBytesAreIdentical) {
  const TemporaryFolder folder;
  RecordTable(Rendered(), 1, folder.path() / "a");
  RecordTable(Rendered(), 1, folder.path() / "b");
  const Comparison comparison = ComparedSessions(folder.path() / "a", folder.path() / "b");
  EXPECT_EQ(comparison.content_sha256.size(), 64U);
  EXPECT_TRUE(comparison.Same());
}

TEST(CompareSessions, AFrameAtAWrongAngleIsFoundAndNamed) {
  const TemporaryFolder folder;
  sim::SyntheticSession wrong = Rendered();
  wrong.frames[1].image = RenderTable(2, 0.1).frames[1].image;  // its pose and angle are as before
  RecordTable(Rendered(), 1, folder.path() / "a");
  RecordTable(wrong, 2, folder.path() / "b");
  const Comparison comparison = ComparedSessions(folder.path() / "a", folder.path() / "b");
  EXPECT_THAT(DifferentIn(comparison), AllOf(Contains("frame 1 (30.0 deg): shifts of blocks"),
                                             Each(StartsWith("frame 1 (30.0 deg): "))));
}

TEST(CompareSessions, ABrightnessOfOneFrameIsFoundAndNamed) {
  const TemporaryFolder folder;
  sim::SyntheticSession brighter = Rendered();
  brighter.frames[2].image = cv::Mat(brighter.frames[2].image * 1.01);
  RecordTable(Rendered(), 1, folder.path() / "a");
  RecordTable(brighter, 2, folder.path() / "b");
  const Comparison comparison = ComparedSessions(folder.path() / "a", folder.path() / "b");
  EXPECT_THAT(DifferentIn(comparison), AllOf(Contains("frame 2 (60.0 deg): brightness"),
                                             Each(StartsWith("frame 2 (60.0 deg): "))));
  const auto found =
      std::find_if(comparison.quantities.begin(), comparison.quantities.end(),
                   [](const ComparedQuantity& quantity) {
                     return quantity.group == "frame 2 (60.0 deg)" && quantity.name == "brightness";
                   });
  EXPECT_NEAR(*found->difference, 0.01, 0.0005);
  EXPECT_THAT(found->remark, HasSubstr("% brighter"));
}

// A session as it is, and with a change of what session.json says.
std::vector<std::string> DifferentAfter(const std::function<void(Session&)>& change) {
  const TemporaryFolder folder;
  const sim::SyntheticSession& rendered = Rendered();
  RecordTable(rendered, 1, folder.path() / "a");
  RecordTable(rendered, 1, folder.path() / "b");
  Session session = TableSession(rendered);
  change(session);
  EXPECT_TRUE(WriteSession(session, folder.path() / "b"));
  return DifferentIn(ComparedSessions(folder.path() / "a", folder.path() / "b"));
}

TEST(CompareSessions, EverythingThatASessionSays) {
  const std::vector<std::pair<std::string, std::function<void(Session&)>>> changes{
      {"session: lens, largest shift",
       [](Session& s) {
         s.camera = calib::CameraModel::Pinhole(320, 240, 640.1, 640, 159.5, 119.5);
       }},
      {"radiometry: white", [](Session& s) { s.radiometry.white = s.radiometry.white + 1.0; }},
      {"radiometry: white_balance", [](Session& s) { s.radiometry.white_balance[0] = 1.01; }},
      {"session: length unit", [](Session& s) { s.length_unit = "m"; }},
      {"session: target", [](Session& s) { s.target = calib::SphereShape{40.1}; }},
      {"frame 1 (30.0 deg): angle", [](Session& s) { s.frames[1].angle_deg = 30.01; }},
      {"frame 1 (30.0 deg): measured angle",
       [](Session& s) { s.frames[1].angle_measured_deg = 30.0; }},
      {"frame 3 (90.0 deg): exposure",
       [](Session& s) { s.frames[3].exposure.exposure_us = 8001.0; }},
      {"frame 2 (60.0 deg): target's pose, rotation",
       [](Session& s) {
         s.frames[2].X_WT.rotation =
             Eigen::AngleAxisd(1e-4, Eigen::Vector3d::UnitZ()) * s.frames[2].X_WT.rotation;
       }},
      {"frame 2 (60.0 deg): camera's pose, shift",
       [](Session& s) { s.frames[2].X_WC.translation.x() += 0.01; }}};
  for (const auto& [name, change] : changes)
    EXPECT_THAT(DifferentAfter(change), Contains(name)) << name;
  EXPECT_THAT(DifferentAfter([](Session& s) { s.name = "another"; }), ElementsAre());
  EXPECT_THAT(DifferentAfter([](Session& s) { s.frames[2].X_WC.translation.x() += 0.001; }),
              ElementsAre());
}

TEST(CompareSessions, AFrameThatIsMissingIsNamedByItsAngle) {
  EXPECT_THAT(DifferentAfter([](Session& s) { s.frames.erase(s.frames.begin() + 1); }),
              ElementsAre("session: frames", "frame 1 (30.0 deg) of A: frame"));
}

TEST(CompareSessions, AnotherKindOfPicture) {
  const TemporaryFolder folder;
  RecordTable(Rendered(), 1, folder.path() / "a");
  RecordTable(Rendered(), 1, folder.path() / "b");
  const std::filesystem::path image = folder.path() / "b/frames/001.png";
  ASSERT_TRUE(WriteImage(image, cv::Mat(240, 320, CV_8UC3, cv::Scalar::all(7))));
  EXPECT_THAT(DifferentIn(ComparedSessions(folder.path() / "a", folder.path() / "b")),
              ElementsAre("frame 1 (30.0 deg): picture"));
}

TEST(CompareSessions, ABadSessionIsRefused) {
  const TemporaryFolder folder;
  RecordTable(Rendered(), 1, folder.path() / "a");
  RecordTable(Rendered(), 1, folder.path() / "b");
  std::filesystem::remove(folder.path() / "b/frames/002.png");
  const auto comparison = CompareSessions(folder.path() / "a", folder.path() / "b",
                                          StandardTolerances(SessionQuantities()));
  ASSERT_FALSE(comparison);
  EXPECT_EQ(comparison.error().kind, ErrorKind::kInput);
  EXPECT_THAT(comparison.error().text, AllOf(HasSubstr("002.png"), HasSubstr("turnlight verify")));
}

}  // namespace
}  // namespace turnlight::rig
