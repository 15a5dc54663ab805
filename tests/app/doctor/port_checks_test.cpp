// Proves: what is said of a port that is missing, forbidden or named by the order of plugging, with
// the line that mends it. Does not prove: what the system says of a real adapter.
#include "app/doctor/port_checks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/app/doctor/patient_of.h"

namespace turnlight::app {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(PortChecks, Access) {
  const auto missing = JudgePortAccess({.path = "/dev/ttyUSB0"});
  EXPECT_EQ(missing.verdict, Verdict::kFailed);
  EXPECT_THAT(missing.advice, HasSubstr("turnlight devices"));
  const auto forbidden = JudgePortAccess({"/dev/ttyUSB0", true, false, true, "dialout", "ada"});
  EXPECT_EQ(forbidden.verdict, Verdict::kFailed);
  EXPECT_EQ(forbidden.advice, "sudo usermod -aG dialout ada, then log in anew");
  const auto nobodys = JudgePortAccess({"/dev/ttyUSB0", true, false, false, "root", "ada"});
  EXPECT_THAT(nobodys.advice, AllOf(HasSubstr("SUBSYSTEM==\"tty\", KERNEL==\"ttyUSB0\""),
                                    HasSubstr("udevadm"), HasSubstr("usermod -aG dialout ada")));
  const auto simulated = JudgePortAccess({"/dev/pts/7", true, false, false, "root", "ada"});
  EXPECT_THAT(simulated.advice, HasSubstr("run the simulated controller as ada"));
  EXPECT_EQ(JudgePortAccess({"/dev/ttyUSB0", true, true, true, "dialout", "ada"}).verdict,
            Verdict::kOk);
}

TEST(PortChecks, Names) {
  EXPECT_EQ(JudgePortName("/dev/serial/by-id/usb-X", {}).verdict, Verdict::kOk);
  EXPECT_EQ(JudgePortName("/dev/ttyS0", {}).verdict, Verdict::kSkipped);
  rig::serial::PortInfo info{"/dev/ttyUSB0", "/dev/serial/by-id/usb-X", "", "A1", "0403:6001"};
  EXPECT_THAT(JudgePortName("/dev/ttyUSB0", info).advice,
              HasSubstr("port: /dev/serial/by-id/usb-X"));
  info.stable_path.clear();
  EXPECT_THAT(JudgePortName("/dev/ttyUSB0", info).advice,
              AllOf(HasSubstr("ATTRS{idVendor}==\"0403\", ATTRS{idProduct}==\"6001\", "
                              "ATTRS{serial}==\"A1\""),
                    HasSubstr("port: /dev/turntable")));
}

TEST(PortChecks, OfAConfig) {
  PatientOf none("rig: {camera: {driver: fake}}\n");
  EXPECT_EQ(CheckPortAccess(none.patient).verdict, Verdict::kSkipped);
  PatientOf missing("rig: {table: {driver: fake, port: /dev/turnlight-none}}\n");
  EXPECT_EQ(CheckPortAccess(missing.patient).verdict, Verdict::kFailed);
  EXPECT_EQ(CheckPortHolder(missing.patient).verdict, Verdict::kSkipped);
  PatientOf unplugged("rig: {table: {driver: fake, usb_serial: turnlight-none}}\n");
  EXPECT_THAT(CheckPortAccess(unplugged.patient).figure, HasSubstr("turnlight-none"));
  EXPECT_EQ(CheckPortName(unplugged.patient).verdict, Verdict::kOk);
}

}  // namespace
}  // namespace turnlight::app
