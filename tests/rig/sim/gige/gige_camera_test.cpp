// Proves, with a plain client of Aravis', that the simulated camera describes itself with standard
// names, that a software trigger gives the picture of the table's angle of that instant with the
// noise of the mock camera's and the same bits for a retake, that exposure, gain, black level and
// region act and read back, that each format has the bytes that it should, and that two cameras
// live side by side. Does not prove anything of turnlight's driver, nor how fast frames come.
#include "rig/sim/gige/gige_camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <thread>

#include "tests/rig/sim/gige/gige_bench.h"

namespace turnlight::rig::sim::gige {
namespace {

std::uint64_t HostNs() { return static_cast<std::uint64_t>(g_get_real_time()) * 1000; }

std::vector<std::uint8_t> BytesOf(const cv::Mat& picture) {
  return {picture.datastart, picture.dataend};
}

TEST(GigeCamera, SaysWhoItIsAndWhatItHas) {
  const GigeBench bench;
  const Client client(bench.config.address);
  ASSERT_TRUE(client.open());
  EXPECT_EQ(client.Text("DeviceVendorName"), IdentityOf(bench.config).vendor);
  EXPECT_EQ(client.Text("DeviceModelName"), IdentityOf(bench.config).model);
  EXPECT_EQ(client.Text("DeviceSerialNumber"), "SIM-CAMERA-1");
  EXPECT_STREQ(arv_camera_get_vendor_name(client.camera(), nullptr), "turnlight");
  EXPECT_EQ(client.Integer("SensorWidth"), 64);
  EXPECT_EQ(client.Integer("SensorHeight"), 48);
  EXPECT_EQ(client.Integer("Width"), 64);
  EXPECT_EQ(client.Integer("PayloadSize"), 64 * 48 * 3);
  EXPECT_EQ(client.Text("PixelFormat"), "RGB8");
  EXPECT_EQ(client.Integer("GevTimestampTickFrequency"), 1'000'000'000);
  EXPECT_NEAR(client.Float("DeviceTemperature"), 41.5, 0.01);
  guint count = 0;
  const char** names = arv_device_dup_available_enumeration_feature_values_as_strings(
      client.device(), "PixelFormat", &count, nullptr);
  EXPECT_EQ(count, PixelFormats().size());
  g_free(names);
  for (const char* feature :
       {"AcquisitionMode", "AcquisitionFrameRate", "ExposureTime", "Gain", "BlackLevel",
        "TriggerMode", "TriggerSource", "TriggerSoftware", "GevSCPSPacketSize", "ExposureAuto"})
    EXPECT_TRUE(arv_device_is_feature_available(client.device(), feature, nullptr)) << feature;
}

TEST(GigeCamera, ItsClockIsTheHosts) {
  const GigeBench bench;
  const Client client(bench.config.address);
  ASSERT_TRUE(client.open());
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  arv_device_execute_command(client.device(), "TimestampLatch", nullptr);
  EXPECT_NEAR(static_cast<double>(client.Integer("TimestampLatchValue")),
              static_cast<double>(HostNs()), 1e9);
}

TEST(GigeCamera, ATriggerGivesThePictureOfTheAngle) {
  GigeBench bench;
  Client client(bench.config.address);
  ASSERT_TRUE(client.open());
  client.Start();
  std::uint64_t last_id = 0;
  for (const double angle_deg : {0.0, 10.0, 123.4}) {
    bench.Move(angle_deg);
    const std::uint64_t before = HostNs();
    const ClientFrame frame = client.Shoot();
    EXPECT_GE(frame.timestamp_ns, before);
    EXPECT_LE(frame.timestamp_ns, HostNs());
    EXPECT_GT(frame.id, last_id);
    last_id = frame.id;
    EXPECT_EQ(frame.bytes, BytesOf(bench.Picture(angle_deg, 8))) << angle_deg;
    // By the renderer alone: 5 standard deviations of the noise, and the rounding.
    const SyntheticConfig& scene = bench.world.config.camera.scene;
    const cv::Mat3f radiance =
        RenderPlacement(*bench.world.studio, PlaceAt(scene.motion, angle_deg)).radiance;
    ASSERT_EQ(frame.bytes.size(), 3 * radiance.total());
    for (std::size_t i = 0; i < frame.bytes.size(); ++i) {
      const float expected = radiance(static_cast<int>(i / 3))[static_cast<int>(i % 3)];
      const double sigma = std::hypot(0.002, 0.004 * std::sqrt(expected));
      ASSERT_NEAR(frame.bytes[i], std::min(255.0, 255.0 * expected), 5 * 255 * sigma + 0.5) << i;
    }
  }
}

TEST(GigeCamera, ARetakeIsTheSameBitsAlsoOfACameraThatWasStartedAnew) {
  std::vector<std::uint8_t> first;
  for (int start = 0; start < 2; ++start) {
    GigeBench bench;
    Client client(bench.config.address);
    ASSERT_TRUE(client.open());
    client.Start();
    for (int retake = 0; retake < 2; ++retake) {
      bench.Move(50.0);
      const ClientFrame frame = client.Shoot();
      if (first.empty()) first = frame.bytes;
      EXPECT_EQ(frame.bytes, first);
      bench.Move(20.0);
      EXPECT_NE(client.Shoot().bytes, first);
    }
  }
}

TEST(GigeCamera, ExposureAndGainActAndReadBackAsTheyWereSet) {
  GigeBench bench({}, "BayerRG16");
  Client client(bench.config.address);
  ASSERT_TRUE(client.open());
  EXPECT_EQ(client.Float("ExposureTime"), 8000.0);
  EXPECT_EQ(client.Float("Gain"), 0.0);
  client.Start();
  bench.Move(30.0);
  for (const CameraSettings& settings :
       {CameraSettings{4000.0, 0.0}, CameraSettings{1234.0, 2.3}, CameraSettings{2000.0, 6.0}}) {
    client.Set("ExposureTime", settings.exposure_us);
    client.Set("Gain", settings.gain_db);
    EXPECT_EQ(client.Float("ExposureTime"), settings.exposure_us);
    EXPECT_DOUBLE_EQ(client.Float("Gain"), settings.gain_db);
    EXPECT_EQ(client.Shoot().bytes,
              Pack(bench.Picture(30.0, 16, settings), *FindPixelFormat(std::string("BayerRG16")),
                   {0, 0, 64, 48}));
  }
  client.Set("ExposureTime", 999.6);
  EXPECT_EQ(client.Float("ExposureTime"), 1000.0);
}

TEST(GigeCamera, EachColourFormatHasTheBytesOfTheStudiosPicture) {
  for (const PixelFormat& format : PixelFormats()) {
    if (format.layout == PixelLayout::kMono) continue;
    GigeBench bench({}, format.name);
    Client client(bench.config.address);
    ASSERT_TRUE(client.open());
    client.Start();
    bench.Move(70.0);
    const ClientFrame frame = client.Shoot();
    EXPECT_EQ(frame.format, format.code);
    EXPECT_EQ(frame.bytes, Pack(bench.Picture(70.0, format.bits), format, {0, 0, 64, 48}))
        << format.name;
  }
}

// The mean of the channels' radiance; here without noise.
TEST(GigeCamera, EachGreyFormatHasTheBytesOfTheMean) {
  for (const PixelFormat& format : PixelFormats()) {
    if (format.layout != PixelLayout::kMono) continue;
    GigeBench bench({}, format.name, [](CameraConfig& config) {
      config.camera.scene.sensor.noise_relative = config.camera.scene.sensor.noise_shot = 0.0;
    });
    Client client(bench.config.address);
    ASSERT_TRUE(client.open());
    client.Start();
    bench.Move(70.0);
    const ClientFrame frame = client.Shoot();
    const SyntheticConfig& scene = bench.world.config.camera.scene;
    const cv::Mat3f radiance =
        RenderPlacement(*bench.world.studio, PlaceAt(scene.motion, 70.0)).radiance;
    cv::Mat grey(radiance.size(), format.bits == 8 ? CV_8U : CV_16U);
    const double white = (1 << format.bits) - 1;
    for (int i = 0; i < static_cast<int>(radiance.total()); ++i) {
      const cv::Vec3f& pixel = radiance(i);
      const float mean = (pixel[0] + pixel[1] + pixel[2]) / 3.0f;
      const double dn = std::floor(std::min<double>(mean, 1.0) * white + 0.5);
      if (format.bits == 8)
        grey.at<std::uint8_t>(i) = static_cast<std::uint8_t>(dn);
      else
        grey.at<std::uint16_t>(i) = static_cast<std::uint16_t>(dn);
    }
    EXPECT_EQ(frame.bytes, Pack(grey, format, {0, 0, 64, 48})) << format.name;
  }
}

TEST(GigeCamera, ARegionIsCutOutAndTheMosaicStaysAtItsPlace) {
  GigeBench bench({}, "BayerRG8");
  Client client(bench.config.address);
  ASSERT_TRUE(client.open());
  client.Set("Width", std::int64_t{32});
  client.Set("Height", std::int64_t{16});
  client.Set("OffsetX", std::int64_t{20});
  client.Set("OffsetY", std::int64_t{30});
  client.Start();
  bench.Move(70.0);
  const ClientFrame frame = client.Shoot();
  EXPECT_EQ(frame.width, 32);
  EXPECT_EQ(frame.height, 16);
  EXPECT_EQ(frame.bytes, Pack(bench.Picture(70.0, 8), *FindPixelFormat(std::string("BayerRG8")),
                              {20, 30, 32, 16}));
}

TEST(GigeCamera, BinningIsRefusedByTheDescription) {
  const GigeBench bench;
  const Client client(bench.config.address);
  ASSERT_TRUE(client.open());
  gint64 low = 0, high = 0;
  arv_device_get_integer_feature_bounds(client.device(), "BinningHorizontal", &low, &high, nullptr);
  EXPECT_EQ(low, 1);
  EXPECT_EQ(high, 1);
}

TEST(GigeCamera, TheBlackLevelIsAdded) {
  GigeBench bench({}, "Mono12");
  Client client(bench.config.address);
  ASSERT_TRUE(client.open());
  client.Set("BlackLevel", 100.0);
  EXPECT_EQ(client.Float("BlackLevel"), 100.0);
  client.Start();
  const ClientFrame frame = client.Shoot();
  double sum = 0.0;
  for (int i = 0; i < 16; ++i) sum += frame.bytes[2 * i] + 256 * frame.bytes[2 * i + 1];
  EXPECT_NEAR(sum / 16.0, 100.0, 5.0);  // a corner without light
}

TEST(GigeCamera, WithoutTriggersItRunsFreely) {
  GigeBench bench;
  Client client(bench.config.address);
  ASSERT_TRUE(client.open());
  client.Set("AcquisitionFrameRate", 50.0);
  EXPECT_DOUBLE_EQ(client.Float("AcquisitionFrameRate"), 50.0);
  client.Start(false);
  std::uint64_t last = 0;
  for (int i = 0; i < 3; ++i) {
    const auto frame = client.Pop();
    ASSERT_TRUE(frame);
    EXPECT_GT(frame->id, last);
    last = frame->id;
  }
}

TEST(GigeCamera, TwoLiveSideBySide) {
  GigeBench one;
  GigeBench two({}, "Mono8", [](CameraConfig& config) {
    config.address = OwnAddress(1);
    config.camera.serial = "SIM-CAMERA-2";
  });
  Client first(one.config.address), second(two.config.address);
  ASSERT_TRUE(first.open() && second.open());
  EXPECT_EQ(first.Text("DeviceSerialNumber"), "SIM-CAMERA-1");
  EXPECT_EQ(second.Text("DeviceSerialNumber"), "SIM-CAMERA-2");
  first.Start();
  second.Start();
  one.Move(10.0);
  two.Move(20.0);
  EXPECT_EQ(first.Shoot().bytes, BytesOf(one.Picture(10.0, 8)));
  EXPECT_EQ(second.Shoot().bytes.size(), 64u * 48u);
}

TEST(GigeCamera, ASecondOneAtTheAddressIsRefused) {
  const GigeBench bench;
  const auto second = GigeCamera::Start(bench.config, bench.world, bench.origin);
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().kind, ErrorKind::kInput);
  EXPECT_THAT(second.error().text, ::testing::HasSubstr(bench.config.address + ":3956"));
}

TEST(GigeCamera, ItCounts) {
  GigeBench bench;
  Client client(bench.config.address);
  ASSERT_TRUE(client.open());
  client.Start();
  for (int i = 0; i < 3; ++i) client.Shoot();
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_EQ(bench.camera->counts().triggers, 3u);
  EXPECT_EQ(bench.camera->counts().frames, 3u);
}

// Destroyed while a client waits for a frame; another one takes its place, so that the client need
// not wait for a dead camera at its end.
TEST(GigeCamera, ItLeavesInTheMiddleOfAnExposure) {
  GigeBench bench;
  Client client(bench.config.address);
  ASSERT_TRUE(client.open());
  client.Set("ExposureTime", 5e6);
  client.Start();
  client.Trigger();
  bench.camera.reset();
  EXPECT_FALSE(client.Pop(50));
  auto next = GigeCamera::Start(bench.config, bench.world, bench.origin);
  ASSERT_TRUE(next) << next.error().text;
  bench.camera = std::move(*next);
}

}  // namespace
}  // namespace turnlight::rig::sim::gige
