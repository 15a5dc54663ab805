// Proves, on pictures that we did not make: the renderer reproduces POV-Ray's pictures, and the
// estimator finds the lights of POV-Ray's scenes and of real photographs without a hint. Does not
// prove: accuracy beyond these few scenes; the photographs' truth is itself 1 to 2 degrees off.
// Needs the shared data beside the project; skipped, visibly, without it.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <opencv2/imgproc.hpp>

#include "base/angles.h"
#include "base/file.h"
#include "estimator/estimate.h"
#include "estimator/results/scene_json.h"
#include "estimator/target/renderer.h"
#include "rig/session/session.h"
#include "tests/estimator/small_scene.h"

namespace turnlight::estimator {
namespace {

struct Data {
  rig::Session session;
  calib::TargetShape shape;
  std::vector<model::Keyframe> keyframes;
  std::string truth;  // of truth.json
};

std::filesystem::path Folder(const std::string& name) {
  return std::filesystem::path(TURNLIGHT_SHARED_DATA) / name;
}

bool Missing(const std::string& name) {
  return !std::filesystem::exists(Folder(name) / "session.json");
}

Data Load(const std::string& name) {
  auto session = rig::ReadSession(Folder(name));
  EXPECT_TRUE(session) << session.error().text;
  auto shape = rig::ReadTarget(*session);
  EXPECT_TRUE(shape) << shape.error().text;
  const auto truth = ReadFile(Folder(name) / "truth.json", 1 << 20);
  EXPECT_TRUE(truth) << truth.error().text;
  Data data{std::move(*session), std::move(*shape), {}, *truth};
  for (std::size_t i = 0; i < data.session.frames.size(); ++i) {
    const rig::FrameRecord& frame = data.session.frames[i];
    auto images = rig::ReadFrameImages(data.session, i);
    EXPECT_TRUE(images) << images.error().text;
    data.keyframes.push_back(
        {calib::Linearise(images->image, data.session.radiometry, frame.exposure), images->mask,
         frame.X_WC, frame.X_WT});
  }
  return data;
}

struct RenderCase {
  const char* name;
  double rms;
};
class RenderCheck : public testing::TestWithParam<RenderCase> {};

TEST_P(RenderCheck, EveryFrameTwoPixelsInsideTheOutline) {
  if (Missing(GetParam().name)) GTEST_SKIP() << "no shared data " << Folder(GetParam().name);
  const Data data = Load(GetParam().name);
  const auto scene = results::ParseScene(data.truth, "truth.json");
  ASSERT_TRUE(scene) << scene.error().text;
  const target::Geometry geometry(data.shape);
  const calib::RayGrid rays(*data.session.camera);
  for (std::size_t k = 0; k < data.keyframes.size(); ++k) {
    const model::Keyframe& keyframe = data.keyframes[k];
    const target::Rendering rendering =
        target::Render(*scene, geometry, rays, keyframe.X_WC, keyframe.X_WT);
    cv::Mat1b inside = rendering.coverage > 0.9999f;
    cv::erode(inside, inside, cv::Mat1b::ones(5, 5));
    ASSERT_GT(cv::countNonZero(inside), 1000);
    cv::Mat difference = rendering.radiance - keyframe.image.radiance;
    const double rms =
        cv::norm(difference, cv::NORM_L2, inside) / std::sqrt(3.0 * cv::countNonZero(inside));
    EXPECT_LE(rms, GetParam().rms) << "frame " << k;
  }
}

INSTANTIATE_TEST_SUITE_P(PovRay, RenderCheck,
                         testing::Values(RenderCase{"pov_orbit_sphere_3", 5e-5},
                                         RenderCase{"pov_orbit_plane_1", 5e-5},
                                         RenderCase{"pov_matte_sphere_1", 5e-5},
                                         RenderCase{"pov_table_mesh_2", 5e-4}));

// Every product, direction, distance and the shininess against the truth.
void ExpectTruth(const Estimate& estimate, const model::Scene& truth) {
  ASSERT_EQ(estimate.lights.size(), truth.lights.size());
  const model::Reflectance& r = truth.reflectance;
  for (const model::Light& light : truth.lights) {
    const LightEstimate* nearest = &estimate.lights.front();
    for (const LightEstimate& other : estimate.lights) {
      if (AngleDeg(other.light.direction, light.direction) <
          AngleDeg(nearest->light.direction, light.direction))
        nearest = &other;
    }
    EXPECT_LT(AngleDeg(nearest->light.direction, light.direction), 0.02);
    ASSERT_TRUE(nearest->distance.has_value());
    EXPECT_NEAR(*nearest->distance * light.inverse_distance, 1.0, 0.003);
    for (int c = 0; c < 3; ++c) {
      const double product = r.albedo[c] * r.diffuse * light.intensity;
      EXPECT_NEAR(nearest->diffuse_product[c] / product, 1.0, 0.01);
    }
    if (r.lobes[0].strength > 0.0) {
      EXPECT_NEAR(nearest->specular_product[0] / (r.lobes[0].strength * light.intensity), 1.0,
                  0.01);
    }
  }
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(estimate.ambient_product[c] / (r.albedo[c] * r.ambient), 1.0, 0.01);
  if (r.lobes[0].strength > 0.0) {
    EXPECT_NEAR(estimate.reflectance.lobes[0].shape / r.lobes[0].shape, 1.0, 0.01);
  } else {
    EXPECT_EQ(estimate.reflectance.lobes[0].model, model::SpecularModel::kNone);
  }
}

class PovScene : public testing::TestWithParam<const char*> {};

TEST_P(PovScene, IsFoundWithoutAHint) {
  if (Missing(GetParam())) GTEST_SKIP() << "no shared data " << Folder(GetParam());
  const Data data = Load(GetParam());
  const auto truth = results::ParseScene(data.truth, "truth.json");
  ASSERT_TRUE(truth);
  const auto output = EstimateScene(data.keyframes, target::Geometry(data.shape),
                                    calib::RayGrid(*data.session.camera), {});
  ASSERT_TRUE(output) << output.error().text;
  ExpectTruth(output->estimate, *truth);
}

INSTANTIATE_TEST_SUITE_P(PovRay, PovScene,
                         testing::Values("pov_orbit_plane_1", "pov_matte_sphere_1",
                                         "pov_orbit_sphere_3"));

TEST(PovSceneTest, ThreeLightsFromAHintFiveDegreesOff) {
  if (Missing("pov_orbit_sphere_3")) GTEST_SKIP() << "no shared data";
  const Data data = Load("pov_orbit_sphere_3");
  const auto truth = results::ParseScene(data.truth, "truth.json");
  ASSERT_TRUE(truth);
  EstimateOptions options;
  options.initial = model::InitialGuess{};
  double turn = 0.0;
  for (model::Light light : truth->lights) {
    const Eigen::Vector3d across =
        Eigen::AngleAxisd(turn += 2.0, light.direction) * light.direction.unitOrthogonal();
    light.direction = (light.direction + std::tan(DegToRad(5.0)) * across).normalized();
    light.inverse_distance = 0.0;
    options.initial->lights.push_back(light);
  }
  const auto output = EstimateScene(data.keyframes, target::Geometry(data.shape),
                                    calib::RayGrid(*data.session.camera), options);
  ASSERT_TRUE(output) << output.error().text;
  ExpectTruth(output->estimate, *truth);
}

struct RealPhotograph {
  model::InitialGuess truth;
  Estimate estimate;
};

void Take(const std::string& name, RealPhotograph& out) {
  const Data data = Load(name);
  auto truth = results::ParseInitialGuess(data.truth, "truth.json");
  ASSERT_TRUE(truth);
  auto output = EstimateScene(data.keyframes, target::Geometry(data.shape),
                              calib::RayGrid(*data.session.camera), {});
  ASSERT_TRUE(output) << output.error().text;
  out = {std::move(*truth), std::move(output->estimate)};
}

TEST(PhotographTest, OneLightEachWithinTwoDegreesInTheMean) {
  const char* const names[] = {"uw_gray_00", "uw_gray_03", "uw_gray_04",
                               "uw_gray_05", "uw_gray_06", "uw_gray_08"};
  double sum = 0.0;
  for (const char* name : names) {
    if (Missing(name)) GTEST_SKIP() << "no shared data " << Folder(name);
    RealPhotograph taken;
    Take(name, taken);
    if (HasFatalFailure()) return;
    const auto& [truth, estimate] = taken;
    ASSERT_EQ(estimate.lights.size(), 1u) << name;
    const double error =
        AngleDeg(estimate.lights[0].light.direction, truth.lights[0].direction.normalized());
    EXPECT_LE(error, 3.1) << name;
    sum += error;
  }
  EXPECT_LE(sum / 6.0, 2.0);
}

// Of a glossy ball, clipped: the truth is good to 0.4 degree, 1.0 at worst.
TEST(PhotographTest, EveryLightOfAGlossyBallByItsHighlight) {
  double sum = 0.0;
  int lights = 0;
  for (const char* name : {"single_003", "single_047", "single_091", "sum2_003_067", "sum2_079_083",
                           "sum3_011_039_043", "sum4_019_047_059_079"}) {
    SCOPED_TRACE(name);
    const std::string folder = std::string("diligent_ball/") + name;
    if (Missing(folder)) GTEST_SKIP() << "no shared data " << Folder(folder);
    RealPhotograph taken;
    Take(folder, taken);
    if (HasFatalFailure()) return;
    const auto& [truth, estimate] = taken;
    ASSERT_EQ(estimate.lights.size(), truth.lights.size());
    for (const LightEstimate& light : estimate.lights) {
      double error = 180.0;
      for (const auto& other : truth.lights)
        error = std::min(error, AngleDeg(light.light.direction, other.direction.normalized()));
      EXPECT_LE(error, 1.3);
      EXPECT_LE(RadToDeg(light.direction_sigma), 0.8);
      EXPECT_FALSE(light.distance);
      sum += error;
      ++lights;
    }
  }
  EXPECT_LE(sum / lights, 0.5);
}

}  // namespace
}  // namespace turnlight::estimator
