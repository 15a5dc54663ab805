// Proves: what is said of socket buffers, packet sizes and USB3 Vision cameras, with the line that
// mends it, from what a system says; the way to the loopback is found. Does not prove: that packets
// get lost without it; CheckPackets measures that.
#include "app/doctor/network_checks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/app/doctor/patient_of.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

TEST(NetworkChecks, SocketBuffer) {
  EXPECT_EQ(JudgeSocketBuffer(4194304, 4000000).verdict, Verdict::kOk);
  const auto small = JudgeSocketBuffer(212992, 4000000);
  EXPECT_EQ(small.verdict, Verdict::kWarning);
  EXPECT_THAT(small.figure, AllOf(HasSubstr("212992"), HasSubstr("4000000")));
  EXPECT_THAT(small.advice, AllOf(HasSubstr("sudo sysctl -w net.core.rmem_max=4000000"),
                                  HasSubstr("/etc/sysctl.d/")));
  EXPECT_EQ(JudgeSocketBuffer(std::nullopt, 1).verdict, Verdict::kSkipped);
}

TEST(NetworkChecks, PacketSize) {
  EXPECT_EQ(JudgeMtu("lo", 65536, 9000).verdict, Verdict::kOk);
  const auto usual = JudgeMtu("eth0", 1500, 1440);
  EXPECT_EQ(usual.verdict, Verdict::kWarning);
  EXPECT_THAT(usual.advice, HasSubstr("sudo ip link set dev eth0 mtu 9000"));
  EXPECT_EQ(JudgeMtu("eth0", 1500, 9000).verdict, Verdict::kFailed);
  EXPECT_EQ(InterfaceTo("127.0.0.7"), "lo");
  EXPECT_EQ(InterfaceTo("no address"), "");
}

// As the kernel shows a camera on the second port of the first bus.
TEST(NetworkChecks, UsbCameras) {
  const TemporaryFolder folder;
  const fs::path devices = folder.path() / "sys/bus/usb/devices";
  const fs::path node = folder.path() / "dev/bus/usb/001/005";
  fs::create_directories(devices / "1-2");
  fs::create_directories(devices / "1-2:1.0");
  fs::create_directories(devices / "1-3:1.0");
  fs::create_directories(node.parent_path());
  WriteText(devices / "1-2/busnum", "1\n");
  WriteText(devices / "1-2/devnum", "5\n");
  WriteText(devices / "1-2/idVendor", "2676\n");
  WriteText(devices / "1-2:1.0/bInterfaceClass", "ef\n");
  WriteText(devices / "1-2:1.0/bInterfaceSubClass", "05\n");
  WriteText(devices / "1-2:1.0/bInterfaceProtocol", "00\n");
  WriteText(devices / "1-3:1.0/bInterfaceClass", "03\n");
  EXPECT_FALSE(FindUsbCameras(folder.path() / "sys", folder.path() / "dev").front().allowed);
  WriteText(node, "");
  const auto cameras = FindUsbCameras(folder.path() / "sys", folder.path() / "dev");
  ASSERT_EQ(cameras.size(), 1u);
  EXPECT_EQ(cameras[0].node, node);
  EXPECT_EQ(cameras[0].vendor, "2676");
  EXPECT_EQ(JudgeUsbAccess(cameras).verdict, Verdict::kOk);
  const auto forbidden = JudgeUsbAccess({{node, "2676", false}});
  EXPECT_EQ(forbidden.verdict, Verdict::kFailed);
  EXPECT_THAT(forbidden.advice, HasSubstr("ATTR{idVendor}==\"2676\", GROUP=\"plugdev\""));
  EXPECT_EQ(JudgeUsbAccess({}).verdict, Verdict::kFailed);
}

TEST(NetworkChecks, OnlyOfCamerasOfAravis) {
  PatientOf fake(kFakeRig);
  for (const auto check :
       {CheckCameraSeen, CheckUsbAccess, CheckUsbMemory, CheckSocketBuffer, CheckMtu})
    EXPECT_EQ(check(fake.patient).verdict, Verdict::kSkipped);
  PatientOf gige(
      "rig: {camera: {driver: aravis, id: 127.0.0.9, pixel_format: Mono8, size: [8, 8], "
      "socket_buffer_kb: 900000}}\n");
  EXPECT_THAT(CheckSocketBuffer(gige.patient).figure, HasSubstr("900000000 asked for"));
  EXPECT_THAT(CheckMtu(gige.patient).figure, HasSubstr("lo takes packets of"));
  EXPECT_EQ(CheckUsbAccess(gige.patient).verdict, Verdict::kSkipped);
}

}  // namespace
}  // namespace turnlight::app
