// Proves, with a scene made for each: a refusal names the cause that was put into the pictures, and
// what it says to do would mend it; never "expose longer" where the pictures are bright, "move
// closer" where the mesh is wound inwards, "lower the exposure" where the saturation is set too
// low. Does not prove the thresholds between causes: usable_test has those.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>
#include <variant>
#include <vector>

#include "base/random.h"
#include "tests/estimator/small_scene.h"

namespace turnlight::estimator {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

rig::sim::SyntheticSession Make(const rig::sim::SyntheticConfig& config) {
  auto session = rig::sim::SynthesizeInMemory(config);
  EXPECT_TRUE(session) << session.error().text;
  return *session;
}

std::string Refusal(const std::vector<model::Keyframe>& keyframes,
                    const rig::sim::SyntheticSession& session) {
  const auto output = EstimateScene(keyframes, target::Geometry(session.target),
                                    calib::RayGrid(session.camera), {});
  if (output) return "an estimate";
  EXPECT_EQ(output.error().kind, ErrorKind::kNoEstimate);
  EXPECT_THAT(output.error().text, Not(HasSubstr("{")));
  return output.error().text;
}
std::string Refusal(const rig::sim::SyntheticSession& session) {
  return Refusal(rig::sim::ToKeyframes(session), session);
}

// Three views of a lump that turns.
rig::sim::SyntheticConfig Lump() {
  rig::sim::SyntheticConfig config = TwoLightBall(5, 0.003, 0.1);
  config.target = rig::sim::Blob{.radius = 40.0, .depth = 0.3, .segments = 48};
  config.motion.kind = rig::sim::MotionKind::kTable;
  config.motion.frames = 3;
  config.motion.step_deg = 50.0;
  config.camera = {.width = 60, .height = 45, .focal_px = 150.0, .distortion = {}};
  return config;
}

void TurnFaces(calib::TargetShape& target) {
  auto& mesh = std::get<calib::MeshShape>(target);
  for (auto& face : mesh.faces) std::swap(face[1], face[2]);
  for (auto& normal : mesh.normals) normal = -normal;
}

TEST(Refusals, NothingOfTheTarget) {
  const auto session = Make(Lump());
  auto keyframes = rig::sim::ToKeyframes(session);
  for (auto& keyframe : keyframes) keyframe.mask = cv::Mat1b(keyframe.mask.size(), std::uint8_t{0});
  EXPECT_THAT(Refusal(keyframes, session), HasSubstr("The masks leave no pixel: check them"));
  keyframes = rig::sim::ToKeyframes(session);
  for (auto& keyframe : keyframes) keyframe.X_WT.translation = {0.0, 0.0, 1e4};
  EXPECT_THAT(Refusal(keyframes, session), HasSubstr("No pixel shows the target: check the poses"));
}

TEST(Refusals, AMeshWoundInwards) {
  auto session = Make(Lump());
  TurnFaces(session.target);
  EXPECT_THAT(
      Refusal(session),
      AllOf(HasSubstr("100 % of what is seen of the target is seen from behind: the mesh is wound"),
            Not(HasSubstr("closer"))));
}

TEST(Refusals, WhatIsNoNumber) {
  auto session = Make(Lump());
  for (auto& frame : session.frames) {
    frame.image.convertTo(frame.image, CV_32F);
    frame.image.setTo(cv::Scalar::all(std::numeric_limits<double>::quiet_NaN()));
  }
  EXPECT_THAT(Refusal(session), AllOf(HasSubstr("are no numbers (NaN or infinite)"),
                                      Not(HasSubstr("lower the exposure"))));
}

TEST(Refusals, ClippedByTheSensorOrByASetting) {
  rig::sim::SyntheticConfig config = Lump();
  config.sensor.clip_share = 0.9;
  config.sensor.noise_relative = 0.0;
  std::get<model::Reflectance>(config.reflectance).ambient = 0.6;
  const std::string clipped = Refusal(Make(config));
  EXPECT_THAT(clipped, HasSubstr("are clipped: lower the exposure or the gain"));

  auto session = Make(Lump());
  session.radiometry.saturation = 6500.0;  // a little above black
  EXPECT_THAT(Refusal(session),
              AllOf(HasSubstr("set saturation (or white"), Not(HasSubstr("lower the exposure"))));
}

TEST(Refusals, LostInTheDarkOrInNoise) {
  rig::sim::SyntheticConfig config = Lump();
  config.sensor.black = 0.0;
  for (auto& light : LightsOf(config)) light.intensity *= 0.01;
  std::get<model::Reflectance>(config.reflectance).ambient = 0.0005;
  config.sensor.noise_relative = 0.02;
  EXPECT_THAT(Refusal(Make(config)), AllOf(HasSubstr("are lost in noise; bright ones reach 0.0"),
                                           HasSubstr("expose longer")));
  rig::sim::SyntheticConfig noisy = Lump();
  noisy.sensor.black = 0.0;
  noisy.sensor.noise_relative = 0.35;
  EXPECT_THAT(Refusal(Make(noisy)),
              AllOf(HasSubstr("are lost in noise, though bright ones reach"),
                    HasSubstr("lower the gain and lengthen"), Not(HasSubstr("expose longer"))));
}

TEST(Refusals, TooObliqueAndTooSmall) {
  rig::sim::SyntheticConfig flat = Lump();
  flat.target = calib::PlaneShape{300.0, 300.0, 1};
  flat.motion.elevation_deg = 3.5;
  flat.motion.distance = 1000.0;
  flat.camera = {.width = 120, .height = 60, .focal_px = 900.0, .distortion = {}};
  EXPECT_THAT(Refusal(Make(flat)), HasSubstr("too obliquely: look at it more from the front"));
  rig::sim::SyntheticConfig far = Lump();
  far.motion.distance = 6000.0;
  EXPECT_THAT(Refusal(Make(far)), HasSubstr("at the outline or across a crease: move the camera"));
}

TEST(Refusals, BlackAndNoSurface) {
  auto session = Make(Lump());
  auto keyframes = rig::sim::ToKeyframes(session);
  for (auto& keyframe : keyframes) keyframe.image.radiance.setTo(cv::Scalar::all(0.0));
  EXPECT_THAT(Refusal(keyframes, session), HasSubstr("every usable pixel is black"));
  const RandomStream random(3, 1);
  std::uint64_t draw = 0;
  for (auto& keyframe : keyframes)
    for (cv::Vec3f& value : cv::Mat3f(keyframe.image.radiance)) {
      const double level = random.Uniform(draw++) < 0.38 ? random.Uniform(draw++, 0.02, 0.4)
                                                         : 0.6 + 0.003 * random.Normal(draw++);
      value = cv::Vec3f::all(static_cast<float>(level));
    }
  EXPECT_THAT(Refusal(keyframes, session),
              HasSubstr("the pictures show something else than a surface"));
}

// Pictures of nothing but noise about a level.
void FillWithNoise(std::vector<model::Keyframe>& keyframes, double level, double sigma) {
  std::uint64_t draw = 0;
  const RandomStream random(7, 2);
  for (auto& keyframe : keyframes)
    for (cv::Vec3f& value : cv::Mat3f(keyframe.image.radiance))
      for (int c = 0; c < 3; ++c)
        value[c] = static_cast<float>(level + sigma * random.Normal(draw++));
}

TEST(Refusals, NoLightInTheNoise) {
  const auto session = Make(Lump());
  auto keyframes = rig::sim::ToKeyframes(session);
  FillWithNoise(keyframes, 0.02, 0.01);
  EXPECT_THAT(Refusal(keyframes, session),
              AllOf(HasSubstr("no light explains more"), HasSubstr("expose longer")));
  FillWithNoise(keyframes, 0.5, 0.2);
  EXPECT_THAT(Refusal(keyframes, session), AllOf(HasSubstr("no light explains more"),
                                                 HasSubstr("of white: lower the gain and lengthen"),
                                                 Not(HasSubstr("expose longer"))));
}

// A pattern that is bound to the picture, whatever the surface does.
TEST(Refusals, NoLightInWhatDoesNotGoWithTheSurface) {
  const auto session = Make(Lump());
  auto keyframes = rig::sim::ToKeyframes(session);
  for (std::size_t k = 0; k < keyframes.size(); ++k) {
    cv::Mat3f radiance = keyframes[k].image.radiance;
    for (int row = 0; row < radiance.rows; ++row)
      for (int column = 0; column < radiance.cols; ++column)
        radiance(row, column) = cv::Vec3f::all(
            0.5f + 0.4f * std::sin(0.35f * static_cast<float>(row + (k % 2 ? column : -column)) +
                                   1.3f * static_cast<float>(k)));
  }
  EXPECT_THAT(Refusal(keyframes, session),
              AllOf(HasSubstr("vary by more than noise"), HasSubstr("check the poses"),
                    Not(HasSubstr("expose longer"))));
  // A mesh whose faces are turned here and there.
  auto torn = session;
  auto& faces = std::get<calib::MeshShape>(torn.target).faces;
  for (std::size_t i = 0; i < faces.size() / 3; ++i) std::swap(faces[i][1], faces[i][2]);
  EXPECT_THAT(Refusal(keyframes, torn),
              AllOf(HasSubstr("no light explains the pictures"), HasSubstr("seen from behind"),
                    HasSubstr("wound inwards in part")));
  // The same picture at every angle: a buffer that was saved again and again.
  for (auto& keyframe : keyframes) keyframe.image.radiance = keyframes[0].image.radiance.clone();
  EXPECT_THAT(Refusal(keyframes, session),
              AllOf(HasSubstr("2 of 3 pictures are copies of others, value for value"),
                    HasSubstr("saved twice"), Not(HasSubstr("expose longer"))));
}

// All that is seen of it faces up.
TEST(Refusals, APlaneDoesNotSayWhereTheLightIs) {
  rig::sim::SyntheticConfig config;
  config.seed = 37;
  config.target = calib::PlaneShape{80.0, 80.0, 1};
  config.motion = {rig::sim::MotionKind::kTable, 1, 120.0, 420.0, 30.0, 0.0};
  config.camera = {.width = 80, .height = 60, .focal_px = 130.0, .distortion = {}};
  config.lights = rig::sim::RandomLights{.count = 1};
  config.reflectance = rig::sim::RandomReflectance{.specular = {0.0, 0.3}};
  config.sensor.depth = rig::sim::SensorDepth::k8;
  config.sensor.noise_relative = 0.05;
  EXPECT_THAT(Refusal(Make(config)),
              AllOf(HasSubstr("direction of the brightest light is not known to 45 degrees"),
                    HasSubstr("use a target that bends")));
}

}  // namespace
}  // namespace turnlight::estimator
