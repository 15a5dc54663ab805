// Proves that the generator is repeatable for any number of threads, that its poses and noise are
// what the config says, that clipping and encodings follow the radiometry, and that a written
// session is the one in memory. Does not prove that the renderer is right; tests/estimator does.
#include "rig/sim/synthetic_session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "base/angles.h"
#include "base/file.h"
#include "base/parallel.h"
#include "estimator/results/scene_json.h"
#include "rig/session/session.h"
#include "tests/temporary_folder.h"

namespace turnlight::rig::sim {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

SyntheticConfig SmallScene() {
  SyntheticConfig config;
  config.motion.frames = 3;
  config.camera = {64, 48, 110.0, {}};
  config.samples_per_side = 2;
  return config;
}

bool SamePicture(const cv::Mat& a, const cv::Mat& b) {
  return a.type() == b.type() && a.size() == b.size() &&
         cv::norm(a.reshape(1), b.reshape(1), cv::NORM_INF) == 0.0;
}

SyntheticSession Make(const SyntheticConfig& config) {
  auto session = SynthesizeInMemory(config);
  EXPECT_TRUE(session) << session.error().text;
  if (!session) std::abort();
  return std::move(*session);
}

TEST(SyntheticSession, SameBitsForAnyNumberOfThreads) {
  SyntheticConfig config = SmallScene();
  config.target = Blob{40.0, 0.3, 32};
  config.sensor.noise_relative = 0.01;
  config.sensor.noise_shot = 0.01;
  SetThreads(1);
  const SyntheticSession reference = Make(config);
  for (const int threads : {2, 7}) {
    SetThreads(threads);
    const SyntheticSession session = Make(config);
    for (std::size_t i = 0; i < reference.frames.size(); ++i) {
      EXPECT_TRUE(SamePicture(session.frames[i].image, reference.frames[i].image)) << threads;
      EXPECT_TRUE(SamePicture(session.frames[i].mask, reference.frames[i].mask)) << threads;
    }
  }
  SetThreads(0);
}

TEST(SyntheticSession, CameraLooksAtTheTarget) {
  for (const MotionKind kind : {MotionKind::kOrbit, MotionKind::kTable}) {
    SyntheticConfig config = SmallScene();
    config.motion.kind = kind;
    config.motion.elevation_deg = 25.0;
    const SyntheticSession session = Make(config);
    for (int i = 0; i < 3; ++i) {
      const SyntheticFrame& frame = session.frames[i];
      const Eigen::Vector3d p_CO = frame.X_WC.Inverse() * Eigen::Vector3d::Zero();
      EXPECT_NEAR((p_CO - Eigen::Vector3d(0, 0, 420)).norm(), 0.0, 1e-9);
      EXPECT_NEAR(frame.X_WC.rotation.determinant(), 1.0, 1e-12);
      EXPECT_NEAR(RadToDeg(std::asin(frame.X_WC.translation.z() / 420.0)), 25.0, 1e-9);
      EXPECT_EQ(frame.angle_deg, 30.0 * i);
      // The camera seen from the target goes one way in an orbit, the other way on the table.
      const Eigen::Vector3d p_TC = frame.X_WT.Inverse() * frame.X_WC.translation;
      const double azimuth_deg = RadToDeg(std::atan2(p_TC.y(), p_TC.x()));
      EXPECT_NEAR(azimuth_deg, kind == MotionKind::kOrbit ? 30.0 * i : -30.0 * i, 1e-9);
    }
  }
}

TEST(SyntheticSession, TiltLeansThePlaneToTheFirstCamera) {
  SyntheticConfig config = SmallScene();
  config.target = calib::PlaneShape{100.0, 80.0, 1};
  config.motion.kind = MotionKind::kTable;
  config.motion.tilt_deg = 20.0;
  const SyntheticSession session = Make(config);
  const Eigen::Vector3d normal_W = session.frames[0].X_WT.rotation.col(2);
  const double to_camera_deg =
      RadToDeg(std::acos(normal_W.dot(session.frames[0].X_WC.translation.normalized())));
  EXPECT_NEAR(to_camera_deg, 90.0 - 30.0 - 20.0, 1e-9);
  // The normal turns with the table.
  EXPECT_NEAR(session.frames[1].X_WT.rotation.col(2).z(), std::cos(DegToRad(20.0)), 1e-12);
  EXPECT_NEAR(session.frames[1].X_WT.rotation.col(2).y(),
              std::sin(DegToRad(20.0)) * std::sin(DegToRad(30.0)), 1e-12);
}

// Mean and standard deviation of noisy minus clean, over pixels whose clean signal is in the range.
std::pair<double, double> NoiseOf(const SyntheticSession& clean, const SyntheticSession& noisy,
                                  double low, double high) {
  double sum = 0.0, squares = 0.0, count = 0.0;
  for (std::size_t i = 0; i < clean.frames.size(); ++i) {
    const cv::Mat1f a = clean.frames[i].image.reshape(1), b = noisy.frames[i].image.reshape(1);
    for (int row = 0; row < a.rows; ++row)
      for (int column = 0; column < a.cols; ++column) {
        if (a(row, column) < low || a(row, column) > high) continue;
        const double difference = b(row, column) - a(row, column);
        sum += difference;
        squares += difference * difference;
        ++count;
      }
  }
  EXPECT_GT(count, 5000);
  return {sum / count, std::sqrt(squares / count)};
}

TEST(SyntheticSession, NoiseHasTheStatedSigma) {
  SyntheticConfig config = SmallScene();
  config.motion.frames = 6;
  config.sensor.depth = SensorDepth::kFloat;
  config.sensor.saturation = 100.0;
  // An even light: the plane's signal is the ambient term, 0.25.
  config.target = calib::PlaneShape{400.0, 400.0, 2};
  estimator::model::Reflectance flat;
  flat.ambient = 0.25;
  flat.diffuse = 0.0;
  config.reflectance = flat;
  const SyntheticSession clean = Make(config);
  config.sensor.noise_relative = 0.02;
  const auto [mean, sigma] = NoiseOf(clean, Make(config), 0.2499, 0.2501);
  EXPECT_NEAR(mean, 0.0, 4.0 * 0.02 / std::sqrt(5000.0));
  EXPECT_NEAR(sigma, 0.02, 0.02 * 0.05);
  config.sensor.noise_shot = 0.06;
  const double expected = std::sqrt(0.02 * 0.02 + 0.06 * 0.06 * 0.25);
  EXPECT_NEAR(NoiseOf(clean, Make(config), 0.2499, 0.2501).second, expected, expected * 0.05);
}

TEST(SyntheticSession, NoiseDiffersFromFrameToFrameAndSeedToSeed) {
  SyntheticConfig config = SmallScene();
  config.motion.step_deg = 0.0;
  config.sensor.noise_relative = 0.01;
  config.lights = std::vector<LightSpec>{{{0, 0, 1}, {}, 1.0, {1, 1, 1}}};
  config.reflectance = estimator::model::Reflectance{};
  const SyntheticSession a = Make(config);
  EXPECT_FALSE(SamePicture(a.frames[0].image, a.frames[1].image));
  config.seed = 2;
  EXPECT_FALSE(SamePicture(a.frames[0].image, Make(config).frames[0].image));
}

// Lambert without ambient light: radiance goes with the lamp.
TEST(SyntheticSession, ALampsFactorsAreInItsFrames) {
  SyntheticConfig config = SmallScene();
  config.motion.step_deg = 0.0;
  config.lights = std::vector<LightSpec>{{{0, 0, 1}, {}, 0.6, {1, 1, 1}, {1.0, 0.5, 1.25}}};
  estimator::model::Reflectance matte;
  matte.lobes[0] = {};
  config.reflectance = matte;
  const auto keyframes = ToKeyframes(Make(config));
  const cv::Scalar one = cv::mean(keyframes[0].image.radiance);
  for (std::size_t k = 1; k < 3; ++k) {
    const double factor = k == 1 ? 0.5 : 1.25;
    EXPECT_NEAR(cv::mean(keyframes[k].image.radiance)[1] / one[1], factor, 1e-3) << k;
  }
}

double ClippedShare(const SyntheticSession& session) {
  double clipped = 0.0, all = 0.0;
  for (const auto& keyframe : ToKeyframes(session)) {
    clipped += cv::countNonZero(keyframe.image.saturated & keyframe.mask);
    all += cv::countNonZero(keyframe.mask);
  }
  return clipped / all;
}

TEST(SyntheticSession, ClipShareIsMetAndRadianceStaysThatOfTheScene) {
  SyntheticConfig config = SmallScene();
  const SyntheticSession plain = Make(config);
  for (const double share : {0.0, 0.05, 0.3}) {
    config.sensor.clip_share = share;
    const SyntheticSession session = Make(config);
    EXPECT_NEAR(ClippedShare(session), share, 0.005);
    const auto keyframes = ToKeyframes(session), expected = ToKeyframes(plain);
    cv::Mat difference, usable = keyframes[0].image.saturated == 0;
    cv::absdiff(keyframes[0].image.radiance, expected[0].image.radiance, difference);
    difference.setTo(0.0, ~usable);
    EXPECT_LT(cv::norm(difference.reshape(1), cv::NORM_INF), 1e-4) << share;
  }
}

TEST(SyntheticSession, EncodingsGiveTheSameRadiance) {
  SyntheticConfig config = SmallScene();
  config.sensor.depth = SensorDepth::kFloat;
  config.sensor.saturation = 100.0;
  const auto reference = ToKeyframes(Make(config));
  struct Case {
    SensorDepth depth;
    calib::Encoding encoding;
    double black, white, tolerance;
  };
  for (const Case& c : {Case{SensorDepth::k16, calib::Encoding::kLinear, 256.0, 60000.0, 1e-5},
                        Case{SensorDepth::k16, calib::Encoding::kSrgb, 0.0, 65535.0, 3e-5},
                        Case{SensorDepth::k8, calib::Encoding::kGamma, 0.0, 255.0, 5e-3}}) {
    config.sensor = Sensor{};
    config.sensor.depth = c.depth;
    config.sensor.encoding = c.encoding;
    config.sensor.black = c.black;
    config.sensor.white = c.white;
    const auto keyframes = ToKeyframes(Make(config));
    for (std::size_t i = 0; i < keyframes.size(); ++i) {
      cv::Mat difference;
      cv::absdiff(keyframes[i].image.radiance, reference[i].image.radiance, difference);
      difference.setTo(0.0, keyframes[i].image.saturated);
      EXPECT_LT(cv::norm(difference.reshape(1), cv::NORM_INF), c.tolerance);
    }
  }
}

TEST(SyntheticSession, AWrittenSessionIsTheOneInMemory) {
  SyntheticConfig config = SmallScene();
  config.target = Blob{40.0, 0.3, 32};
  config.masks = true;
  config.sensor.clip_share = 0.01;
  config.camera.distortion = {{-0.05, 0.01, 0, 0, 0, 0, 0, 0}};
  const TemporaryFolder folder;
  std::vector<std::size_t> calls;
  const auto report = WriteSynthetic(config, folder.path() / "s", [&](auto done, auto total) {
    EXPECT_EQ(total, 3u);
    calls.push_back(done);
    return true;
  });
  ASSERT_TRUE(report) << report.error().text;
  EXPECT_THAT(calls, ElementsAre(1u, 2u, 3u));
  EXPECT_NEAR(report->clipped_share, 0.01, 0.005);
  const auto session = ReadSession(folder.path() / "s");
  ASSERT_TRUE(session) << session.error().text;
  const SyntheticSession memory = Make(config);
  EXPECT_EQ(session->camera->intrinsics(), memory.camera.intrinsics());
  ASSERT_EQ(session->frames.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto images = ReadFrameImages(*session, i);
    ASSERT_TRUE(images) << images.error().text;
    EXPECT_TRUE(SamePicture(images->image, memory.frames[i].image));
    EXPECT_TRUE(SamePicture(images->mask, memory.frames[i].mask));
    EXPECT_EQ(session->frames[i].X_WC.rotation, memory.frames[i].X_WC.rotation);
    EXPECT_EQ(session->frames[i].exposure.exposure_us, memory.frames[i].exposure.exposure_us);
  }
  const auto truth = ReadFile(folder.path() / "s" / "truth.json", 1 << 20);
  ASSERT_TRUE(truth) << truth.error().text;
  const auto scene = estimator::results::ParseScene(*truth, "truth.json");
  ASSERT_TRUE(scene) << scene.error().text;
  EXPECT_EQ(scene->lights[1].direction, memory.scene.lights[1].direction);
  EXPECT_EQ(scene->reflectance.lobes[0].shape, memory.scene.reflectance.lobes[0].shape);
  const auto verified = VerifySession(folder.path() / "s");
  ASSERT_TRUE(verified) << verified.error().text;
  EXPECT_THAT(verified->problems, ElementsAre());
  const auto target = ReadTarget(*session);
  ASSERT_TRUE(target) << target.error().text;
  EXPECT_EQ(std::get<calib::MeshShape>(*target).vertices,
            std::get<calib::MeshShape>(memory.target).vertices);
}

TEST(SyntheticSession, EveryFormatReadsBack) {
  for (const auto& [depth, format] :
       {std::pair{SensorDepth::k8, FileFormat::kPng}, std::pair{SensorDepth::k8, FileFormat::kTiff},
        std::pair{SensorDepth::k16, FileFormat::kTiff},
        std::pair{SensorDepth::kFloat, FileFormat::kExr},
        std::pair{SensorDepth::kFloat, FileFormat::kTiff}}) {
    SyntheticConfig config = SmallScene();
    config.motion.frames = 1;
    config.sensor.depth = depth;
    config.sensor.format = format;
    const TemporaryFolder folder;
    const auto report = WriteSynthetic(config, folder.path());
    ASSERT_TRUE(report) << report.error().text;
    const auto session = ReadSession(folder.path());
    ASSERT_TRUE(session) << session.error().text;
    const auto images = ReadFrameImages(*session, 0);
    ASSERT_TRUE(images) << images.error().text;
    EXPECT_TRUE(SamePicture(images->image, Make(config).frames[0].image));
  }
}

TEST(SyntheticSession, RemarksOnClippingAndEmptyFrames) {
  SyntheticConfig config = SmallScene();
  config.target = calib::PlaneShape{100.0, 80.0, 1};
  config.motion.frames = 1;
  config.lights = std::vector<LightSpec>{{{0, 0, 1}, {}, 5.0, {1, 1, 1}}};
  config.reflectance = estimator::model::Reflectance{};
  {
    const TemporaryFolder folder;
    const auto report = WriteSynthetic(config, folder.path());
    ASSERT_TRUE(report) << report.error().text;
    EXPECT_GT(report->clipped_share, 0.5);
    EXPECT_THAT(report->remarks, ElementsAre(HasSubstr("clipped")));
  }
  config.motion.elevation_deg = -30.0;  // below a one-sided plane
  const TemporaryFolder folder;
  const auto report = WriteSynthetic(config, folder.path());
  ASSERT_TRUE(report) << report.error().text;
  EXPECT_THAT(report->remarks, ElementsAre(HasSubstr("nothing of the target")));
}

TEST(SyntheticSession, StoppingLeavesNoSession) {
  const TemporaryFolder folder;
  const auto report =
      WriteSynthetic(SmallScene(), folder.path(), [](auto done, auto) { return done < 2; });
  ASSERT_TRUE(report) << report.error().text;
  EXPECT_TRUE(report->stopped);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "session.json"));
}

TEST(SyntheticSession, AnInvalidConfigIsRefused) {
  SyntheticConfig config;
  config.motion.distance = 10.0;
  const auto session = SynthesizeInMemory(config);
  ASSERT_FALSE(session);
  EXPECT_THAT(session.error().text, HasSubstr("motion/distance: 10"));
}

}  // namespace
}  // namespace turnlight::rig::sim
