// Proves: a camera on the network is found, with what a config may name it by, and opens by each of
// these; one that is not there is refused with those that are. Does not prove: other subnets, USB.
#include "rig/aravis/find_cameras.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "test_camera.h"

namespace turnlight::rig::aravis {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const std::string kSerial = "F" + std::to_string(::getpid());

TEST(FindCameras, BySerialAddressAndId) {
  FakeCamera fake("", Ramp, kSerial);
  const auto cameras = FindCameras();
  ASSERT_TRUE(cameras) << cameras.error().text;
  const auto found = CameraOf(*cameras, kSerial);
  ASSERT_TRUE(found) << DescribeCameras(*cameras);
  EXPECT_EQ(found->vendor, "Aravis");
  EXPECT_EQ(found->model, "Fake");
  EXPECT_EQ(found->address, TestAddress());
  EXPECT_EQ(found->protocol, "GigEVision");
  for (const std::string& id : {found->id, found->serial, found->address}) {
    AravisConfig config = Config("Mono8");
    config.id = id;
    AravisCamera camera(config);
    const auto opened = camera.Open(Now());
    ASSERT_TRUE(opened) << opened.error().text;
    EXPECT_EQ(opened->model, "Fake");
    EXPECT_TRUE(Shoot(camera));
  }
}

TEST(FindCameras, NoneOfThatName) {
  FakeCamera fake("", nullptr, kSerial);
  AravisConfig config = Config("Mono8");
  config.id = "12345678";
  AravisCamera camera(config);
  const auto opened = camera.Open(Now());
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().kind, ErrorKind::kDevice);
  EXPECT_THAT(opened.error().text, AllOf(HasSubstr("no camera answers to \"12345678\""),
                                         HasSubstr("serial " + kSerial + ", at " + TestAddress())));
}

}  // namespace
}  // namespace turnlight::rig::aravis
