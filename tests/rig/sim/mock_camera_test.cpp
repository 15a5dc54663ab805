// Proves that a frame is the scene at the table's true angle of its exposure (sharp or blurred),
// that retakes and threads give the same bits, that exposure, gain, latency and frame ids are as
// stated, and that each camera fault has its visible effect. Does not prove that the renderer is
// right (tests/estimator does) or that real cameras fail so.
#include "rig/sim/mock_camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>

#include "base/parallel.h"

namespace turnlight::rig::sim {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::HasSubstr;

// A lump, as only a target without symmetry tells one angle from another.
MockCameraConfig Small() {
  MockCameraConfig config;
  config.scene.target = Blob{40.0, 0.3, 24};
  config.scene.motion.kind = MotionKind::kTable;
  config.scene.camera = {40, 30, 75.0, {}};
  config.scene.lights = std::vector<LightSpec>{{{0.5, 0.3, 0.8}, 700.0, 0.5, {1, 1, 1}},
                                               {{0.6, -0.6, 0.5}, {}, 0.3, {1, 1, 1}}};
  estimator::model::Reflectance reflectance;
  reflectance.albedo = {0.9, 0.7, 0.5};
  reflectance.ambient = 0.1;
  reflectance.diffuse = 0.8;
  reflectance.lobes[0].strength = 0.2;
  reflectance.lobes[0].shape = 20.0;
  config.scene.reflectance = reflectance;
  config.scene.sensor.black = 1000.0;
  config.scene.sensor.noise_relative = 0.002;
  config.scene.sensor.noise_shot = 0.004;
  config.scene.samples_per_side = 2;
  return config;
}

bool SameImage(const cv::Mat& a, const cv::Mat& b) {
  return a.type() == b.type() && a.size() == b.size() &&
         cv::norm(a.reshape(1), b.reshape(1), cv::NORM_INF) == 0.0;
}

// A homed table and an open camera, and the time they live in.
struct Bench {
  explicit Bench(const MockCameraConfig& config = Small(), std::vector<FaultEntry> entries = {},
                 const MockTurntableConfig& table_config = {})
      : faults(std::make_shared<FaultScript>(std::move(entries))),
        table(std::make_shared<MockTurntable>(table_config, faults)) {
    auto created = MockCamera::Create(config, table, faults);
    if (!created || !table->Open(now) || !table->Home(now) || !(*created)->Open(now)) std::abort();
    camera = std::move(*created);
    now += seconds(20);
  }
  void Move(double angle_deg) {
    const Status status = table->MoveTo(angle_deg, now);
    EXPECT_TRUE(status) << status.error().text;
    now += seconds(20);
  }
  void Set(double exposure_us, double gain_db = 0.0) {
    const auto set = camera->Set({exposure_us, gain_db}, now);
    EXPECT_TRUE(set) << set.error().text;
  }
  std::optional<RawFrame> Poll() {
    const auto frame = camera->Poll(now);
    EXPECT_TRUE(frame) << frame.error().text;
    return frame ? *frame : std::nullopt;
  }
  // Trigger, and all frames of the following second.
  std::vector<RawFrame> Frames() {
    EXPECT_TRUE(camera->Trigger(now));
    now += seconds(1);
    std::vector<RawFrame> frames;
    while (auto frame = Poll()) frames.push_back(*frame);
    return frames;
  }
  RawFrame Shoot() {
    const auto frames = Frames();
    EXPECT_EQ(frames.size(), 1u);
    if (frames.empty()) std::abort();
    return frames.front();
  }
  bool IsAt(const RawFrame& frame, double angle_deg) const {
    return camera->DeviationFromStatic(frame, angle_deg).max_sigmas < 5.0;
  }

  std::shared_ptr<FaultScript> faults;
  std::shared_ptr<MockTurntable> table;
  std::unique_ptr<MockCamera> camera;
  DeviceTime now{seconds(1)};
};

FaultEntry FaultAt(FaultKind kind, double angle_deg) {
  FaultEntry entry = MakeFault(kind);
  entry.angle_deg = angle_deg;
  return entry;
}

double MeanDn(const RawFrame& frame) { return cv::mean(frame.image.reshape(1))[0]; }

TEST(MockCamera, AFrameIsTheStaticRenderAtItsAngleAndAtNoOther) {
  for (const MotionKind kind : {MotionKind::kTable, MotionKind::kOrbit}) {
    MockCameraConfig config = Small();
    config.scene.motion.kind = kind;
    Bench bench(config);
    for (const double angle_deg : {10.0, 20.0, 200.0}) {
      bench.Move(angle_deg);
      const RawFrame frame = bench.Shoot();
      const auto deviation = bench.camera->DeviationFromStatic(frame, angle_deg);
      EXPECT_LT(deviation.max_sigmas, 5.0) << angle_deg;
      EXPECT_NEAR(deviation.rms_sigmas, 1.0, 0.1) << angle_deg;
      EXPECT_EQ(deviation.share_beyond_5, 0.0) << angle_deg;
      EXPECT_FALSE(bench.IsAt(frame, angle_deg + 1.0)) << angle_deg;
      EXPECT_FALSE(bench.IsAt(frame, -angle_deg)) << angle_deg;
    }
  }
}

TEST(MockCamera, TheTruthCountsNotTheReport) {
  MockTurntableConfig open_loop;
  open_loop.feedback = TableFeedback::kOpenLoop;
  FaultEntry lost = FaultAt(FaultKind::kLostSteps, 20.0);
  lost.amount = 2.0;
  Bench bench(Small(), {lost}, open_loop);
  bench.Move(20.0);
  const RawFrame frame = bench.Shoot();
  EXPECT_EQ(bench.table->State(bench.now)->angle_deg, 20.0);
  EXPECT_TRUE(bench.IsAt(frame, 18.0));
  EXPECT_FALSE(bench.IsAt(frame, 20.0));
}

TEST(MockCamera, OrbitAndTableSeeTheTargetFromTheSameSide) {
  // One turn of the table and the opposite of the orbit differ in the lights alone.
  const calib::RigPoses table = PlaceAt({MotionKind::kTable, 1, 0.0, 420.0, 30.0, 0.0}, 40.0);
  const calib::RigPoses orbit = PlaceAt({MotionKind::kOrbit, 1, 0.0, 420.0, 30.0, 0.0}, -40.0);
  const calib::Pose a = table.X_WT.Inverse() * table.X_WC, b = orbit.X_WT.Inverse() * orbit.X_WC;
  EXPECT_NEAR((a.rotation - b.rotation).norm(), 0.0, 1e-12);
  EXPECT_NEAR((a.translation - b.translation).norm(), 0.0, 1e-9);
}

TEST(MockCamera, RetakesAreTheSameBitsWheneverAndHoweverReached) {
  Bench bench;
  bench.Move(30.0);
  const RawFrame first = bench.Shoot();
  EXPECT_TRUE(SameImage(first.image, bench.Shoot().image));
  for (const double angle_deg : {50.0, 0.0, 77.0, 120.0, 130.0, 140.0, 150.0, 160.0, 170.0, 28.0})
    bench.Move(angle_deg), bench.Shoot();  // also out of the cache
  bench.now += milliseconds(137);
  bench.Move(30.0);
  EXPECT_TRUE(SameImage(first.image, bench.Shoot().image));
  Bench other;
  other.Move(28.0);
  other.Move(30.0);
  EXPECT_TRUE(SameImage(first.image, other.Shoot().image));
}

TEST(MockCamera, SameBitsForAnyNumberOfThreads) {
  std::vector<cv::Mat> images;
  for (const int threads : {1, 2, 7}) {
    SetThreads(threads);
    Bench bench;
    bench.Move(30.0);
    images.push_back(bench.Shoot().image);
  }
  SetThreads(0);
  EXPECT_TRUE(SameImage(images[0], images[1]));
  EXPECT_TRUE(SameImage(images[0], images[2]));
}

TEST(MockCamera, NoiseDiffersByAngleExposureGainAndSeed) {
  // The difference of two retakes is noise alone if they share the rest.
  MockCameraConfig config = Small();
  config.scene.target = calib::SphereShape{50.0};  // looks the same at every angle
  config.scene.sensor.depth = SensorDepth::kFloat;
  config.scene.sensor.black = 0.0;
  const auto shoot = [](const MockCameraConfig& c, double angle_deg, double exposure_us) {
    Bench bench(c);
    bench.Move(angle_deg);
    bench.Set(exposure_us);
    cv::Mat3f image = bench.Shoot().image;
    return image * (8000.0 / exposure_us);
  };
  const cv::Mat3f reference = shoot(config, 10.0, 8000.0);
  EXPECT_TRUE(SameImage(reference, shoot(config, 10.0, 8000.0)));
  EXPECT_FALSE(SameImage(reference, shoot(config, 370.0, 8000.0)));
  EXPECT_FALSE(SameImage(reference, shoot(config, 20.0, 8000.0)));
  const cv::Mat3f shorter = shoot(config, 10.0, 8001.0);
  EXPECT_GT(cv::norm(shorter, reference, cv::NORM_L1) / (3.0 * reference.total()), 5e-4);
  config.scene.seed = 2;
  EXPECT_FALSE(SameImage(reference, shoot(config, 10.0, 8000.0)));
}

TEST(MockCamera, ExposureAndGainScaleTheSignalAndGainTheNoise) {
  MockCameraConfig config = Small();
  config.scene.sensor.depth = SensorDepth::kFloat;
  config.scene.sensor.black = 0.0;
  config.scene.sensor.saturation = 1e6;
  config.scene.sensor.noise_shot = 0.0;
  Bench bench(config);
  bench.Move(10.0);
  const auto mean = [&](double exposure_us, double gain_db) {
    bench.Set(exposure_us, gain_db);
    const RawFrame frame = bench.Shoot();
    EXPECT_EQ(frame.actual.exposure_us, exposure_us);
    EXPECT_EQ(frame.actual.gain_db, gain_db);
    EXPECT_TRUE(bench.IsAt(frame, 10.0));
    EXPECT_EQ(frame.exposure_end - frame.exposure_begin,
              microseconds(static_cast<std::int64_t>(exposure_us)));
    return MeanDn(frame);
  };
  const double reference = mean(8000.0, 0.0);
  EXPECT_NEAR(mean(2000.0, 0.0) / reference, 0.25, 0.01);
  EXPECT_NEAR(mean(8000.0, 20.0) / reference, 10.0, 0.05);
  // The background has no light: what is there is the noise of the electronics.
  const auto background_sigma = [&](double gain_db) {
    bench.Set(8000.0, gain_db);
    const RawFrame frame = bench.Shoot();
    cv::Scalar average, sigma;
    cv::meanStdDev(frame.image.rowRange(0, 4).reshape(1), average, sigma);
    return sigma[0];
  };
  EXPECT_NEAR(background_sigma(0.0), 0.002, 0.0003);
  EXPECT_NEAR(background_sigma(20.0), 0.02, 0.003);
}

TEST(MockCamera, SetClipsRoundsAndReadsBack) {
  Bench bench;
  EXPECT_EQ(bench.camera->Set({1234.567, 3.14}, bench.now)->exposure_us, 1235.0);
  EXPECT_EQ(bench.camera->Set({1234.567, 3.14}, bench.now)->gain_db, 3.1);
  EXPECT_EQ(bench.camera->Set({1e12, 99.0}, bench.now)->exposure_us, 1e7);
  EXPECT_EQ(bench.camera->Set({1e12, 99.0}, bench.now)->gain_db, 24.0);
  EXPECT_EQ(bench.camera->Set({0.5, -3.0}, bench.now)->exposure_us, 10.0);
  EXPECT_FALSE(bench.camera->Set({0.0, 0.0}, bench.now));
  EXPECT_FALSE(bench.camera->Set({std::nan(""), 0.0}, bench.now));
  EXPECT_FALSE(bench.camera->Set({8000.0, std::numeric_limits<double>::infinity()}, bench.now));
}

TEST(MockCamera, LatencyExposureAndReadoutTakeTheirTime) {
  Bench bench;
  bench.Set(20000.0);
  const DeviceTime trigger = bench.now;
  EXPECT_EQ(*bench.camera->Trigger(trigger), 1u);
  bench.now = trigger + microseconds(200 + 20000 + 15000) - DeviceTime(1);
  EXPECT_FALSE(bench.Poll());
  EXPECT_EQ(*bench.camera->Drain(bench.now), 0);  // it is on its way and cannot be drained
  bench.now += DeviceTime(1);
  const auto frame = bench.Poll();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->exposure_begin, trigger + microseconds(200));
  EXPECT_EQ(frame->exposure_end, trigger + microseconds(20200));
  EXPECT_TRUE(frame->complete);
  EXPECT_EQ(frame->trigger, 0u);
  EXPECT_FALSE(bench.Poll());
  // While the shutter is open a trigger is ignored, but counted.
  EXPECT_EQ(*bench.camera->Trigger(bench.now), 2u);
  EXPECT_EQ(*bench.camera->Trigger(bench.now + milliseconds(10)), 3u);
  bench.now += seconds(1);
  EXPECT_EQ(*bench.camera->Drain(bench.now), 1);
}

TEST(MockCamera, FrameIdsWrapFrom65535To1AndTriggersAreToldIfAsked) {
  MockCameraConfig config = Small();
  config.first_frame_id = 65534;
  config.reports_trigger = true;
  Bench bench(config);
  for (const std::uint64_t id : {65534u, 65535u, 1u, 2u}) {
    const RawFrame frame = bench.Shoot();
    EXPECT_EQ(frame.frame_id, id);
    EXPECT_EQ(frame.trigger, (id + 65535 - 65533) % 65535);
  }
}

TEST(MockCamera, AMoveInTheExposureBlursAsTheMeanOverIt) {
  MockCameraConfig config = Small();
  config.scene.sensor = Sensor{};
  config.scene.sensor.depth = SensorDepth::kFloat;
  config.blur_samples = 16;
  Bench bench(config);
  bench.Set(300000.0);
  const DeviceTime begin = bench.now;
  ASSERT_TRUE(bench.table->MoveTo(90.0, begin));
  bench.now = begin + milliseconds(500);
  const RawFrame frame = bench.Shoot();
  cv::Mat3f mean(30, 40, cv::Vec3f(0, 0, 0));
  const int count = 300;
  for (int i = 0; i < count; ++i) {
    const DeviceTime t = frame.exposure_begin + microseconds(1000 * i + 500);
    mean += bench.camera->StaticRender(bench.table->TrueAngleDeg(t)).radiance / count;
  }
  const double factor = 8000.0 / 300000.0;
  const cv::Mat3f radiance =
      calib::Linearise(frame.image, bench.camera->studio().radiometry, {300000.0, 0.0}).radiance;
  EXPECT_EQ(bench.camera->studio().radiometry.reference_exposure_us, 8000.0);
  // Where it does not clip (white is radiance `factor` here): near the mean, far from any one.
  const cv::Mat dark = mean < cv::Scalar::all(0.9 * factor);
  std::vector<cv::Mat> planes;
  cv::split(dark, planes);
  const cv::Mat usable = planes[0] & planes[1] & planes[2];
  EXPECT_GT(cv::countNonZero(usable), 100);
  const double off_mean = cv::norm(radiance, mean, cv::NORM_L2, usable);
  const double off_middle = cv::norm(
      radiance,
      bench.camera->StaticRender(bench.table->TrueAngleDeg(begin + milliseconds(650))).radiance,
      cv::NORM_L2, usable);
  EXPECT_LT(off_mean, 0.3 * off_middle);
}

TEST(MockCamera, StaleFrameComesFirstAndIsOlderThanItsTrigger) {
  Bench bench(Small(), {FaultAt(FaultKind::kStaleFrame, 40.0)});
  bench.Move(10.0);
  const RawFrame good = bench.Shoot();
  ASSERT_TRUE(bench.table->MoveTo(40.0, bench.now));
  bench.now += milliseconds(1800);  // there, and settled, but not for long
  const DeviceTime trigger = bench.now;
  const auto frames = bench.Frames();
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_LT(frames[0].exposure_end, trigger);
  EXPECT_FALSE(bench.IsAt(frames[0], 40.0));
  EXPECT_EQ(frames[0].frame_id, good.frame_id + 1);
  EXPECT_GT(frames[1].exposure_begin, trigger);
  EXPECT_TRUE(bench.IsAt(frames[1], 40.0));
}

TEST(MockCamera, DuplicateFrameComesFirstWithTheOldId) {
  Bench bench(Small(), {FaultAt(FaultKind::kDuplicateFrame, 40.0)});
  bench.Move(10.0);
  const RawFrame good = bench.Shoot();
  bench.Move(40.0);
  EXPECT_EQ(*bench.camera->Drain(bench.now), 0);
  const auto frames = bench.Frames();
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(frames[0].frame_id, good.frame_id);
  EXPECT_EQ(frames[0].exposure_begin, good.exposure_begin);
  EXPECT_TRUE(SameImage(frames[0].image, good.image));
  EXPECT_EQ(frames[1].frame_id, good.frame_id + 1);
  EXPECT_TRUE(bench.IsAt(frames[1], 40.0));
}

TEST(MockCamera, DroppedIgnoredAndUntriggeredFramesAreMissedOrLeftOver) {
  const FaultKind dropped = FaultKind::kDroppedFrame, ignored = FaultKind::kTriggerIgnored,
                  untriggered = FaultKind::kUntriggeredFrame;
  for (const auto& [kind, count, id_after] :
       {std::tuple{dropped, 0u, 3u}, std::tuple{ignored, 0u, 2u},
        std::tuple{untriggered, 2u, 4u}}) {
    Bench bench(Small(), {FaultAt(kind, 40.0)});
    EXPECT_EQ(bench.Shoot().frame_id, 1u);
    bench.Move(40.0);
    EXPECT_EQ(bench.Frames().size(), count) << FaultWord(kind);
    const RawFrame after = bench.Shoot();
    EXPECT_EQ(after.frame_id, id_after) << FaultWord(kind);
    EXPECT_TRUE(bench.IsAt(after, 40.0));
  }
}

TEST(MockCamera, IncompleteFrameSaysSoAndLacksItsLowerHalf) {
  Bench bench(Small(), {FaultAt(FaultKind::kIncompleteFrame, 40.0)});
  bench.Move(40.0);
  const RawFrame frame = bench.Shoot();
  EXPECT_FALSE(frame.complete);
  EXPECT_EQ(cv::countNonZero(frame.image.rowRange(15, 30).reshape(1)), 0);
  EXPECT_GT(cv::countNonZero(frame.image.rowRange(0, 15).reshape(1)), 0);
  EXPECT_TRUE(bench.Shoot().complete);
}

TEST(MockCamera, BlurredFrameIsSeenInTheTablesPositionAfterIt) {
  FaultEntry blurred = FaultAt(FaultKind::kBlurred, 40.0);
  blurred.amount = 3.0;
  Bench bench(Small(), {blurred});
  bench.Move(40.0);
  EXPECT_EQ(bench.table->State(bench.now)->angle_deg, 40.0);
  const RawFrame frame = bench.Shoot();
  EXPECT_FALSE(bench.IsAt(frame, 40.0));
  EXPECT_FALSE(bench.IsAt(frame, 43.0));
  EXPECT_EQ(bench.table->State(frame.exposure_end + seconds(1))->angle_deg, 43.0);
  EXPECT_EQ(bench.table->State(frame.exposure_begin + milliseconds(4))->motion,
            TableMotion::kMoving);
  bench.Move(40.0);
}

TEST(MockCamera, DriftsAreReadBackAndFlickerIsNot) {
  Bench plain;
  plain.Move(40.0);
  const double level = MeanDn(plain.Shoot()) - 1000.0;
  FaultEntry exposure = FaultAt(FaultKind::kExposureDrift, 40.0);
  exposure.amount = 0.1;
  FaultEntry flicker = FaultAt(FaultKind::kFlicker, 40.0);
  flicker.amount = -0.1;
  Bench drifting(Small(), {exposure});
  drifting.Move(40.0);
  const RawFrame longer = drifting.Shoot();
  EXPECT_EQ(longer.actual.exposure_us, 8800.0);
  EXPECT_EQ(longer.exposure_end - longer.exposure_begin, microseconds(8800));
  EXPECT_NEAR((MeanDn(longer) - 1000.0) / level, 1.1, 0.01);
  EXPECT_EQ(drifting.Shoot().actual.exposure_us, 8000.0);
  Bench gained(Small(), {FaultAt(FaultKind::kGainDrift, 40.0)});
  gained.Move(40.0);
  const RawFrame brighter = gained.Shoot();
  EXPECT_EQ(brighter.actual.gain_db, 0.5);
  EXPECT_NEAR((MeanDn(brighter) - 1000.0) / level, std::pow(10.0, 0.5 / 20.0), 0.01);
  Bench flickering(Small(), {flicker});
  flickering.Move(40.0);
  const RawFrame darker = flickering.Shoot();
  EXPECT_EQ(darker.actual.exposure_us, 8000.0);
  EXPECT_NEAR((MeanDn(darker) - 1000.0) / level, 0.9, 0.01);
}

TEST(MockCamera, LampOffLeavesTheAmbientLight) {
  Bench bench(Small(), {FaultAt(FaultKind::kLampOff, 40.0)});
  bench.Move(40.0);
  const RawFrame dark = bench.Shoot(), lit = bench.Shoot();
  EXPECT_TRUE(bench.IsAt(lit, 40.0));
  EXPECT_LT(MeanDn(dark) - 1000.0, 0.5 * (MeanDn(lit) - 1000.0));
  EXPECT_GT(MeanDn(dark) - 1000.0, 0.05 * (MeanDn(lit) - 1000.0));
}

TEST(MockCamera, SaturatedAndAllBlackAreFlat) {
  for (const auto& [kind, dn] :
       {std::pair{FaultKind::kSaturated, 65535.0}, std::pair{FaultKind::kAllBlack, 1000.0}}) {
    Bench bench(Small(), {FaultAt(kind, 40.0)});
    bench.Move(40.0);
    double low = 0.0, high = 0.0;
    cv::minMaxLoc(bench.Shoot().image.reshape(1), &low, &high);
    EXPECT_EQ(low, dn);
    EXPECT_EQ(high, dn);
  }
}

TEST(MockCamera, ControlLostTakesTriggersAndGivesNothingUntilOpened) {
  Bench bench(Small(), {FaultAt(FaultKind::kControlLost, 40.0)});
  bench.Set(4000.0);
  bench.Move(40.0);
  EXPECT_TRUE(bench.Frames().empty());
  EXPECT_TRUE(bench.Frames().empty());
  const auto set = bench.camera->Set({8000.0, 0.0}, bench.now);
  ASSERT_FALSE(set);
  EXPECT_THAT(set.error().text, HasSubstr("control lost"));
  ASSERT_TRUE(bench.camera->Open(bench.now));
  EXPECT_EQ(bench.Shoot().actual.exposure_us, 8000.0);  // the settings are lost
}

TEST(MockCamera, UnpluggedFailsUntilOpenedAgain) {
  FaultEntry entry = FaultAt(FaultKind::kUnplugged, 40.0);
  entry.device = FaultDevice::kCamera;
  Bench bench(Small(), {entry});
  bench.Move(40.0);
  const auto trigger = bench.camera->Trigger(bench.now);
  ASSERT_FALSE(trigger);
  EXPECT_EQ(trigger.error().kind, ErrorKind::kDevice);
  EXPECT_THAT(trigger.error().text, HasSubstr("MOCK-CAMERA-1: unplugged"));
  EXPECT_FALSE(bench.camera->Open(bench.now + milliseconds(499)));
  bench.now += milliseconds(500);
  EXPECT_FALSE(bench.camera->Poll(bench.now));
  EXPECT_EQ(bench.camera->Open(bench.now)->serial, "MOCK-CAMERA-1");
  EXPECT_TRUE(bench.IsAt(bench.Shoot(), 40.0));
}

}  // namespace
}  // namespace turnlight::rig::sim
