// Proves: opening a rig opens both devices and learns who they are; a device that does not open is
// told, and so is a calibration of other devices. Does not prove: anything of real devices.
#include "rig/rig_setup.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace turnlight::rig {
namespace {

using testing::HasSubstr;

class NamedTable : public Turntable {
 public:
  Result<DeviceIdentity> Open(DeviceTime) override { return DeviceIdentity{"V", "T", "1"}; }
  Status Home(DeviceTime) override { return {}; }
  Status MoveTo(double, DeviceTime) override { return {}; }
  Result<TableState> State(DeviceTime) override { return TableState{}; }
  Status Halt(DeviceTime) override { return {}; }
};

class NamedCamera : public Camera {
 public:
  explicit NamedCamera(bool there) : there_(there) {}
  Result<DeviceIdentity> Open(DeviceTime) override {
    if (!there_) return DeviceError("C 2: no such camera");
    return DeviceIdentity{"V", "C", "2"};
  }
  Result<CameraSettings> Set(const CameraSettings& settings, DeviceTime) override {
    return settings;
  }
  Result<int> Drain(DeviceTime) override { return 0; }
  Result<std::uint64_t> Trigger(DeviceTime) override { return 1; }
  Result<std::optional<RawFrame>> Poll(DeviceTime) override { return std::nullopt; }

 private:
  bool there_;
};

RigSetup Rig(bool there) {
  CameraDevice camera;
  camera.camera = std::make_shared<NamedCamera>(there);
  return {.table = {std::make_shared<NamedTable>(), {}},
          .camera = camera,
          .known = {calib::CameraModel::Pinhole(8, 8, 9, 9, 3.5, 3.5), {}, {}, {}},
          .target = {},
          .calibration = {},
          .truth = {},
          .identity = {}};
}

TEST(OpenRig, LearnsWhoTheDevicesAre) {
  RigSetup rig = Rig(true);
  ASSERT_TRUE(OpenRig(rig));
  EXPECT_EQ(Describe(rig.identity->camera), "V, C, 2");
  EXPECT_EQ(Describe(rig.identity->table), "V, T, 1");
}

TEST(OpenRig, ADeviceThatIsNotThereIsTold) {
  RigSetup rig = Rig(false);
  const Status status = OpenRig(rig);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::kDevice);
  EXPECT_EQ(status.error().text, "C 2: no such camera");
  EXPECT_FALSE(rig.identity);
}

TEST(OpenRig, ACalibrationOfOtherDevicesIsRefused) {
  RigSetup rig = Rig(true);
  rig.calibration.emplace(rig.known.lens);
  rig.calibration->source = "r.json";
  rig.calibration->devices.camera = {"V", "C", "3"};
  rig.calibration->devices.table = {"V", "T", "1"};
  const Status status = OpenRig(rig);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::kInput);
  EXPECT_THAT(status.error().text, HasSubstr("identity/camera/serial: \"3\""));
}

}  // namespace
}  // namespace turnlight::rig
