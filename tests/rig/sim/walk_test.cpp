// Proves that a simulated person goes round step by step and stands still in each, smoothly and the
// same for the same seed; that the camera keeps the target in sight from where it should; that the
// picture shows the target before the board; what is refused. Does not test detection.
#include "rig/sim/walk.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/angles.h"
#include "rig/sim/mock_camera.h"
#include "rig/sim/simulation.h"

namespace turnlight::rig::sim {
namespace {

using testing::HasSubstr;

constexpr char kScene[] =
    "target: {shape: sphere, radius: 25}\n"
    "motion: {kind: orbit, distance: 420, elevation_deg: 40}\n"
    "camera: {size: [160, 120], focal_px: 260}\n"
    "samples_per_side: 2\n"
    "walk:\n"
    "  board: {columns: 9, rows: 6, spacing: 16}\n"
    "  at: [0, 0, 25]\n";

Result<SimulationConfig> Read(const std::string& text) {
  const auto document = ParseYaml(text, "walk.yaml");
  if (!document) return Forward(document);
  return ReadSimulation(StrictObject(*document), {});
}

DeviceTime Seconds(double seconds) { return DeviceTime(static_cast<std::int64_t>(seconds * 1e9)); }

TEST(Walk, GoesStepByStepAndStandsInEach) {
  Walk walk;
  walk.speed_deg_s = 6.0;
  walk.step_s = 2.0;
  EXPECT_EQ(WalkedDeg(walk, Seconds(0.0)), 0.0);
  EXPECT_EQ(WalkedDeg(walk, Seconds(1.3)), 12.0);
  EXPECT_EQ(WalkedDeg(walk, Seconds(1.9)), 12.0);
  EXPECT_DOUBLE_EQ(WalkedDeg(walk, Seconds(7.5)), 48.0);
  double last = 0.0;
  for (int i = 1; i < 1000; ++i) {
    const double now = WalkedDeg(walk, Seconds(0.01 * i));
    EXPECT_GE(now, last);
    EXPECT_LT(now - last, 0.2);
    last = now;
  }
}

TEST(Walk, HoldsTheCameraWhereItShould) {
  Walk walk;
  walk.at = {1.0, 2.0, 25.0};
  walk.turn_deg = 90.0;
  const calib::OrbitGeometry orbit{40.0, 420.0, {}};
  double lowest = 90.0, highest = 0.0;
  for (double walked_deg = 0.0; walked_deg < 720.0; walked_deg += 3.0) {
    const calib::RigPoses poses = PosesOf(walk, orbit, walked_deg);
    EXPECT_EQ(poses.X_WT.translation, walk.at);
    EXPECT_NEAR(poses.X_WT.rotation(1, 0), 1.0, 1e-12);
    const Eigen::Vector3d p_CW = poses.X_WC.Inverse().translation;
    EXPECT_NEAR(p_CW.head<2>().norm(), 0.0, 1e-9);  // it looks at W's origin
    EXPECT_NEAR(p_CW.z(), 420.0, 42.1);
    const double elevation_deg = RadToDeg(std::asin(poses.X_WC.translation.z() / p_CW.z()));
    lowest = std::min(lowest, elevation_deg);
    highest = std::max(highest, elevation_deg);
  }
  EXPECT_GT(lowest, 35.9);
  EXPECT_LT(highest, 44.1);
  EXPECT_GT(highest - lowest, 2.0);
}

TEST(Walk, ThePictureShowsTheTargetBeforeTheBoard) {
  const auto config = Read(kScene);
  ASSERT_TRUE(config) << config.error().text;
  const auto studio = BuildStudio(config->camera);
  ASSERT_TRUE(studio) << studio.error().text;
  const auto picture = RenderView(*studio, {20.0});
  const calib::RigPoses poses =
      PosesOf(*studio->walk, std::get<calib::OrbitGeometry>(studio->rig), 20.0);
  const auto target = RenderPlacement(*studio, poses);
  const auto pixel =
      studio->camera.Project({poses.X_WC.Inverse() * poses.X_WT.translation}).front();
  const cv::Point middle(static_cast<int>(pixel.x()), static_cast<int>(pixel.y()));
  EXPECT_EQ(picture.radiance(middle), target.radiance(middle));
  EXPECT_EQ(target.radiance(0, 0), cv::Vec3f(0, 0, 0));
  EXPECT_NEAR(picture.radiance(0, 0)[0], 0.2, 0.01);  // what is round the board
}

TEST(Walk, WhatCannotBeIsRefused) {
  const auto refused = [](std::string text, const std::string& what, const std::string& by) {
    text.replace(text.find(what), what.size(), by);
    const auto config = Read(text);
    return config ? std::string("read") : config.error().text;
  };
  EXPECT_THAT(refused(kScene, "kind: orbit", "kind: table"), HasSubstr("motion/kind is table"));
  EXPECT_THAT(refused(kScene, "walk:", "prop: {kind: dark}\nwalk:"),
              HasSubstr("it stands beside prop"));
  EXPECT_THAT(refused(kScene, "  at: [0, 0, 25]", "  at: [0, 0]"), HasSubstr("at"));
  EXPECT_THAT(refused(kScene, "  at:", "  step_s: 0\n  at:"), HasSubstr("step_s"));
  EXPECT_THAT(refused(kScene, "columns: 9", "columns: 1"), HasSubstr("columns"));
}

}  // namespace
}  // namespace turnlight::rig::sim
