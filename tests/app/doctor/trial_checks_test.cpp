// Proves: lost pictures and packets are counted and told; the levels say what to do; the turn is
// announced, goes once around as a capture would, and sees a picture that differs. Does not prove:
// that a real table loses steps.
#include "app/doctor/trial_checks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/doctor/device_checks.h"
#include "tests/app/doctor/patient_of.h"

namespace turnlight::app {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr char kQuick[] = "capture: {settle_ms: 1, retries: 1}\n";

struct OpenPatient : PatientOf {
  explicit OpenPatient(const std::string& capture = kQuick)
      : PatientOf(capture + std::string(kFakeRig)) {
    CheckController(patient);
    CheckCamera(patient);
  }
};

TEST(TrialChecks, AllPicturesCome) {
  OpenPatient rig;
  EXPECT_EQ(CheckLatency(rig.patient).verdict, Verdict::kSkipped);
  const auto check = CheckPackets(rig.patient);
  EXPECT_EQ(check.verdict, Verdict::kOk);
  EXPECT_THAT(check.figure, AllOf(HasSubstr("100 of 100 pictures good"), HasSubstr("0 packets")));
  EXPECT_THAT(rig.said, HasSubstr("nothing moves"));
  EXPECT_THAT(CheckLatency(rig.patient).figure, HasSubstr("median"));
  EXPECT_EQ(CheckLevels(rig.patient).verdict, Verdict::kWarning);
}

TEST(TrialChecks, LossesAreTold) {
  OpenPatient rig;
  rig.fakes.camera->broken = 1;
  rig.fakes.camera->packets_missing_each = 2.0;
  const auto lossy = CheckPackets(rig.patient);
  EXPECT_EQ(lossy.verdict, Verdict::kWarning);
  EXPECT_THAT(lossy.figure, AllOf(HasSubstr("1 triggered again (1 %)"), HasSubstr("202 packets")));
  rig.fakes.camera->lost = 1000;
  const auto dead = CheckPackets(rig.patient);
  EXPECT_EQ(dead.verdict, Verdict::kFailed);
  EXPECT_THAT(dead.figure, AllOf(HasSubstr("0 of 3 pictures"), HasSubstr("it did not answer")));
  EXPECT_EQ(CheckLatency(rig.patient).verdict, Verdict::kSkipped);
  EXPECT_EQ(CheckLevels(rig.patient).verdict, Verdict::kSkipped);
}

TEST(TrialChecks, LevelsSayWhatToDo) {
  OpenPatient rig;
  rig.fakes.camera->image.setTo(255);
  CheckPackets(rig.patient);
  const auto white = CheckLevels(rig.patient);
  EXPECT_EQ(white.verdict, Verdict::kFailed);
  EXPECT_THAT(white.advice, HasSubstr("100 % clipped: divide the exposure by 8"));
  rig.fakes.camera->image.setTo(200);
  EXPECT_EQ(CheckLevels(rig.patient).verdict, Verdict::kOk);
}

TEST(TrialChecks, OnceAround) {
  OpenPatient rig;
  const auto check = CheckTurn(rig.patient);
  EXPECT_EQ(check.verdict, Verdict::kOk) << check.figure;
  EXPECT_EQ(rig.fakes.table->homings, 1);
  EXPECT_THAT(rig.fakes.table->moves, ElementsAre(-2.0, 0.0, 90.0, 180.0, 270.0, 360.0));
  EXPECT_THAT(rig.said, AllOf(HasSubstr("will home"), HasSubstr("to 0.000 degrees and on to "
                                                                "360.000 degrees")));
}

// Another picture after the turn: brighter in one half.
struct FickleCamera : FakeCamera {
  Result<std::uint64_t> Trigger(rig::DeviceTime now) override {
    image = image.clone();
    if (triggers == 1) image.colRange(0, 32).setTo(140);
    return FakeCamera::Trigger(now);
  }
};

TEST(TrialChecks, ATableThatLostItsPlace) {
  OpenPatient rig;
  rig.patient.devices.camera->camera = std::make_shared<FickleCamera>();
  const auto check = CheckTurn(rig.patient);
  EXPECT_EQ(check.verdict, Verdict::kFailed);
  EXPECT_THAT(check.figure, HasSubstr("the table lost its place"));
  EXPECT_THAT(check.advice, HasSubstr("steps per degree"));
}

TEST(TrialChecks, WhatMustNotMoveDoesNot) {
  OpenPatient still;
  still.patient.options.move = false;
  EXPECT_EQ(CheckTurn(still.patient).figure, "--no-move");
  OpenPatient limited("capture: {count: 2, step_deg: 10, limits_deg: [-10, 200]}\n");
  EXPECT_THAT(CheckTurn(limited.patient).figure, HasSubstr("270 degrees is outside"));
  EXPECT_TRUE(still.fakes.table->moves.empty() && limited.fakes.table->moves.empty());
  OpenPatient stuck;
  stuck.fakes.table->home_fault = "ALARM:9";
  EXPECT_THAT(CheckTurn(stuck.patient).figure, HasSubstr("homing failed: ALARM:9"));
}

}  // namespace
}  // namespace turnlight::app
