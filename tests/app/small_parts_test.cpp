// Proves the small parts of the command line by themselves: progress lines, settings,
// lights, the words at a run's end, interrupts. Does not prove that the commands use them; the
// other tests of this folder do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>

#include "app/capture_display.h"
#include "app/exit_code.h"
#include "app/interrupt.h"
#include "app/progress.h"
#include "app/run_outcome.h"
#include "app/scene_overrides.h"
#include "base/angles.h"

namespace turnlight::app {
namespace {

using ::testing::HasSubstr;

TEST(Progress, LineShowsRateAndTimeLeft) {
  EXPECT_EQ(Progress::Line("rendering", 12, 36, 4.0), "rendering 12/36, 3 per s, 8 s left");
  EXPECT_EQ(Progress::Line("rendering", 1, 100, 2.0),
            "rendering 1/100, 0.5 per s, 3 min 18 s left");
  EXPECT_EQ(Progress::Line("reading", 1, 10000, 1.0), "reading 1/10000, 1 per s, 2 h 46 min left");
  EXPECT_EQ(Progress::Line("rendering", 36, 36, 12.0), "rendering 36/36, 3 per s");
  EXPECT_EQ(Progress::Line("rendering", 0, 36, 0.0), "rendering 0/36");
}

TEST(CaptureDisplay, TellsWhereTheTimeWent) {
  EXPECT_EQ(CaptureDisplay::PaceText({20.0, 10.0, 2.0, 0.4, 0.0}, 36, 40.0),
            "36 frames in 40.0 s, 54.0 a minute; waited for the stage 50 %, its settling 25 %, the "
            "camera 5 %, the disk 1 %");
  EXPECT_THAT(CaptureDisplay::PaceText({1.0, 1.0, 1.0, 1.0, 4.0}, 2, 10.0),
              HasSubstr("the disk 10 %, before repetitions 40 %"));
}

TEST(RunOutcome, SaysWhatEndedTheRunUnlessThatWasShown) {
  nodes::graph::RunReport report;
  report.failure = nodes::graph::Fault{"camera", "device", "gone", false};
  report.hung = {"table"};
  RunOutcome outcome{.report = report, .missing = 2};
  EXPECT_EQ(OutcomeText(outcome, "go on"),
            "turnlight: camera: device: gone\n"
            "turnlight: table: hangs: it did not come back when the run stopped, and was left\n"
            "turnlight: 2 frames are missing, the others are safe; go on\n");
  EXPECT_EQ(ExitCodeOf(outcome), kDeviceFault);
  outcome.failure_shown = true;
  EXPECT_THAT(OutcomeText(outcome, ""), testing::Not(HasSubstr("gone")));
}

TEST(RunOutcome, SaysNothingWhenAllIsDone) {
  const nodes::graph::RunReport report;
  EXPECT_EQ(OutcomeText({.report = report, .session_complete = true}, "go on"), "");
  EXPECT_EQ(ExitCodeOf(RunOutcome{.report = report, .session_complete = true}), kDone);
  EXPECT_EQ(ExitCodeOf(RunOutcome{.report = report}), kIncomplete);
}

TEST(InterruptDeathTest, OneThatCameBeforeEndsWhatNeedNotBeFinished) {
  EXPECT_EXIT(
      {
        InstallInterruptHandler();
        std::raise(SIGINT);
        const InterruptAtOnce reading;
        std::exit(0);
      },
      testing::ExitedWithCode(kInterrupted), "interrupted");
}

std::string SettingError(const std::string& setting) {
  estimator::model::Scene scene;
  scene.lights.resize(2);
  const Status status = ApplySetting(setting, scene);
  return status ? "accepted" : status.error().text;
}

TEST(Settings, ChangeWhatTheySay) {
  estimator::model::Scene scene;
  scene.lights.resize(2);
  for (const char* setting :
       {"shininess=80", "ambient=0.1", "specular=0.2", "diffuse=0.3", "albedo=0.4,0.5,0.6",
        "roughness_deg=20", "model=blinn-phong", "light.1.intensity=0.7"})
    ASSERT_TRUE(ApplySetting(setting, scene)) << setting;
  const estimator::model::Reflectance& r = scene.reflectance;
  EXPECT_EQ(r.lobes[0].shape, 80.0);
  EXPECT_EQ(r.ambient, 0.1);
  EXPECT_EQ(r.lobes[0].strength, 0.2);
  EXPECT_EQ(r.diffuse, 0.3);
  EXPECT_EQ(r.albedo, Eigen::Vector3d(0.4, 0.5, 0.6));
  EXPECT_DOUBLE_EQ(r.roughness, DegToRad(20.0));
  EXPECT_EQ(r.diffuse_model, estimator::model::DiffuseModel::kOrenNayar);
  EXPECT_EQ(r.lobes[0].model, estimator::model::SpecularModel::kBlinnPhong);
  EXPECT_EQ(scene.lights[1].intensity, 0.7);
  EXPECT_EQ(scene.lights[0].intensity, 1.0);
}

TEST(Settings, OfPhysicalLobesAndOfNone) {
  estimator::model::Scene scene;
  estimator::model::Reflectance& r = scene.reflectance;
  for (const char* setting : {"specular=0.2", "model=ggx", "alpha=0.3", "f0=0.04"})
    ASSERT_TRUE(ApplySetting(setting, scene)) << setting;
  EXPECT_EQ(r.lobes[0].shape, 0.3);
  EXPECT_EQ(r.lobes[0].f0, 0.04);
  for (const char* bad : {"f0=0", "f0=0.009", "f0=1.1"}) {
    const Status status = ApplySetting(bad, scene);
    ASSERT_FALSE(status) << bad;
    EXPECT_THAT(status.error().text, HasSubstr("from 0.01 to 1"));
  }
  ASSERT_TRUE(ApplySetting("model=beckmann", scene));
  EXPECT_EQ(r.lobes[0].shape, 0.3);
  r.lobes[1] = {estimator::model::SpecularModel::kPhong, 0.1, 12.0};
  ASSERT_TRUE(ApplySetting("model=none", scene));
  for (const estimator::model::Lobe& lobe : r.lobes) EXPECT_FALSE(lobe.present());
}

TEST(Settings, RefuseTheRest) {
  EXPECT_THAT(SettingError("shininess"), HasSubstr("key=value"));
  EXPECT_THAT(SettingError("=3"), HasSubstr("key=value"));
  EXPECT_THAT(SettingError("shinines=3"), HasSubstr("did you mean shininess?"));
  EXPECT_THAT(SettingError("colour=3"), HasSubstr("allowed are model, albedo"));
  EXPECT_THAT(SettingError("shininess=0.4"), HasSubstr("0.5 to 100000"));
  EXPECT_THAT(SettingError("ambient=-1"), HasSubstr("at least 0"));
  EXPECT_THAT(SettingError("ambient=inf"), HasSubstr("at least 0"));
  EXPECT_THAT(SettingError("ambient=nan"), HasSubstr("at least 0"));
  EXPECT_THAT(SettingError("ambient=0.1x"), HasSubstr("at least 0"));
  EXPECT_THAT(SettingError("albedo=1,2"), HasSubstr("r,g,b"));
  EXPECT_THAT(SettingError("albedo=1,2,-3"), HasSubstr("at least 0"));
  EXPECT_THAT(SettingError("model=velvet"), HasSubstr("blinn-phong"));
  EXPECT_THAT(SettingError("roughness_deg=91"), HasSubstr("0 to 90"));
  EXPECT_THAT(SettingError("light.2.intensity=1"), HasSubstr("2 lights"));
  EXPECT_THAT(SettingError("light.0.colour=1"), HasSubstr("did you mean light.0.intensity?"));
  EXPECT_THAT(SettingError("light.inf.intensity=1"), HasSubstr("light.inf"));
  EXPECT_THAT(SettingError("light.0.5.intensity=1"), HasSubstr("light.0.5"));
}

TEST(Lights, AreReadFromFiveNumbers) {
  const auto near = ParseLight("0,3,4,500,0.5");
  ASSERT_TRUE(near) << near.error().text;
  EXPECT_NEAR((near->direction - Eigen::Vector3d(0, 0.6, 0.8)).norm(), 0.0, 1e-15);
  EXPECT_EQ(near->inverse_distance, 1.0 / 500.0);
  EXPECT_EQ(near->intensity, 0.5);
  const auto distant = ParseLight("-1,0,0,inf,1");
  ASSERT_TRUE(distant) << distant.error().text;
  EXPECT_EQ(distant->inverse_distance, 0.0);
  for (const char* bad : {"0,0,1,500", "0,0,0,500,1", "0,0,1,0,1", "0,0,1,500,-1", "0,0,1,500,inf",
                          "inf,0,1,500,1", "a,0,1,500,1", "0,0,1,500,1,", ""})
    EXPECT_FALSE(ParseLight(bad)) << bad;
}

}  // namespace
}  // namespace turnlight::app
