// Proves: devices that open, note something, do not open or do not do as they are told get the
// verdict that they deserve, with what to do; a calibration is compared with them. Does not prove:
// real devices.
#include "app/doctor/device_checks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rig/sim/studio.h"
#include "tests/app/doctor/patient_of.h"

namespace turnlight::app {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(DeviceChecks, Tables) {
  PatientOf good(kFakeRig);
  EXPECT_EQ(CheckPosition(good.patient).verdict, Verdict::kSkipped);  // not open yet
  EXPECT_EQ(CheckController(good.patient).verdict, Verdict::kOk);
  const auto unhomed = CheckPosition(good.patient);
  EXPECT_EQ(unhomed.verdict, Verdict::kWarning);
  EXPECT_THAT(unhomed.advice, HasSubstr("turnlight home "));
  good.fakes.table->homed = true;
  EXPECT_THAT(CheckPosition(good.patient).figure, HasSubstr("stands at 0.000 degrees"));
  PatientOf noting(kFakeRig);
  noting.fakes.table->notes = {"$1=25: the motor goes slack"};
  const auto noted = CheckController(noting.patient);
  EXPECT_EQ(noted.verdict, Verdict::kWarning);
  EXPECT_THAT(noted.advice, HasSubstr("slack"));
  PatientOf absent(kFakeRig);
  absent.fakes.table->open_fault = "no such port";
  EXPECT_EQ(CheckController(absent.patient).verdict, Verdict::kFailed);
  EXPECT_EQ(CheckPosition(absent.patient).figure, kTableShut);
}

TEST(DeviceChecks, Cameras) {
  PatientOf good("capture: {exposures_us: [100, 200]}\n" + std::string(kFakeRig));
  EXPECT_EQ(CheckExposure(good.patient).verdict, Verdict::kSkipped);
  EXPECT_EQ(CheckCamera(good.patient).verdict, Verdict::kOk);
  EXPECT_THAT(CheckExposure(good.patient).figure, HasSubstr("200 us and 0 dB read back"));
  good.fakes.camera->exposure_factor = 1.01;
  const auto other = CheckExposure(good.patient);
  EXPECT_EQ(other.verdict, Verdict::kFailed);
  EXPECT_THAT(other.advice, HasSubstr("exposures_us"));
  PatientOf absent(kFakeRig);
  absent.fakes.camera->open_fault = "in use";
  EXPECT_EQ(CheckCamera(absent.patient).verdict, Verdict::kFailed);
}

TEST(DeviceChecks, TheWholeConfig) {
  PatientOf part(kFakeRig);
  EXPECT_EQ(CheckRunConfig(part.patient).verdict, Verdict::kSkipped);
  PatientOf whole(SmallRunConfig());
  EXPECT_EQ(CheckRunConfig(whole.patient).verdict, Verdict::kOk);
  PatientOf wrong(std::string(kFakeRig) + "graph: {nodes: {}}\n");
  EXPECT_EQ(CheckRunConfig(wrong.patient).verdict, Verdict::kFailed);
}

TEST(DeviceChecks, Calibrations) {
  PatientOf rig(
      "rig: {table: {driver: fake}, camera: {driver: fake}, calibration: rig-calibration.json}\n");
  EXPECT_EQ(CheckCalibrationPictures(rig.patient).verdict, Verdict::kFailed);  // not there
  const auto studio = rig::sim::BuildStudio(SmallConfig());
  ASSERT_TRUE(studio) << studio.error().text;
  rig::RigCalibration calibration(studio->camera);
  calibration.radiometry = studio->radiometry;
  calibration.radiometry.white = 255.0;
  calibration.devices = {{"turnlight", "fake camera", "C1"},
                         {"turnlight", "fake table", "T1"},
                         {80, 60},
                         {0, 0},
                         {1, 1},
                         ""};
  const auto write = [&] {
    ASSERT_TRUE(rig::WriteRigCalibration(calibration, rig.folder / "rig-calibration.json"));
  };
  write();
  EXPECT_THAT(CheckCalibrationPictures(rig.patient).figure, HasSubstr("80 x 60"));
  rig.patient.devices.camera->format.size = {80, 60};
  EXPECT_EQ(CheckCalibrationPictures(rig.patient).verdict, Verdict::kOk);
  EXPECT_EQ(CheckCalibrationDevices(rig.patient).verdict, Verdict::kSkipped);
  CheckController(rig.patient);
  CheckCamera(rig.patient);
  EXPECT_EQ(CheckCalibrationDevices(rig.patient).verdict, Verdict::kOk);
  calibration.devices.camera.serial = "C2";
  write();
  EXPECT_THAT(CheckCalibrationDevices(rig.patient).figure,
              AllOf(HasSubstr("\"C2\""), HasSubstr("\"C1\"")));
}

}  // namespace
}  // namespace turnlight::app
