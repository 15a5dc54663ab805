// Proves, on pictures of our own renderer (independent pictures: independent_data_test): lights
// that the map does not show are found from the residual, on a target that shadows itself too;
// identical views add no certainty; where the scene was made in other units, at another exposure or
// about another origin, the same lights come out; sigma_total covers errors that are not noise.
// Does not prove coverage at large: bench/studies does.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "base/angles.h"
#include "estimator/estimate.h"
#include "rig/sim/synthetic_session.h"
#include "tests/estimator/small_scene.h"

namespace turnlight::estimator {
namespace {

// The largest distance, degrees, of a light of the scene from its nearest estimate.
double WorstDirection(const Estimate& estimate, const std::vector<rig::sim::LightSpec>& lights) {
  double worst = 0.0;
  for (const rig::sim::LightSpec& light : lights) {
    double nearest = 180.0;
    for (const LightEstimate& found : estimate.lights)
      nearest = std::min(nearest, AngleDeg(found.light.direction, light.direction));
    worst = std::max(worst, nearest);
  }
  return worst;
}

// Eight views of it.
rig::sim::SyntheticConfig SmallScene(double noise) {
  rig::sim::SyntheticConfig config = TwoLightBall(3, noise, 0.1);
  config.motion.frames = 8;
  config.motion.step_deg = 45.0;
  return config;
}

TEST(Starts, EightLightsOnALumpAreFoundFromTenViews) {
  rig::sim::SyntheticConfig config = SmallScene(0.002);
  config.target = rig::sim::Blob{.radius = 40.0, .depth = 0.25, .segments = 96};
  config.motion.kind = rig::sim::MotionKind::kTable;
  config.motion.frames = 10;
  config.motion.step_deg = 36.0;
  config.camera = {.width = 160, .height = 120, .focal_px = 320.0, .distortion = {}};
  std::get<model::Reflectance>(config.reflectance).lobes[0].shape = 60.0;
  LightsOf(config).clear();
  for (int i = 0; i < 8; ++i) {
    const double azimuth = DegToRad(45.0 * i), zenith = DegToRad(i % 2 == 0 ? 25.0 : 60.0);
    LightsOf(config).push_back(
        {.direction = {std::sin(zenith) * std::cos(azimuth), std::sin(zenith) * std::sin(azimuth),
                       std::cos(zenith)},
         .distance = 400.0 + 30.0 * i,
         .intensity = 0.3 + 0.03 * i});
  }
  const auto session = rig::sim::SynthesizeInMemory(config);
  ASSERT_TRUE(session) << session.error().text;
  const auto output = EstimateFrom(*session);
  ASSERT_TRUE(output) << output.error().text;
  EXPECT_EQ(output->estimate.lights.size(), 8u);
  EXPECT_LT(WorstDirection(output->estimate, LightsOf(config)), 0.5);
}

TEST(Sigmas, IdenticalViewsTellWhatOneTells) {
  rig::sim::SyntheticConfig config = SmallScene(0.005);
  config.motion.frames = 1;
  auto session = rig::sim::SynthesizeInMemory(config);
  ASSERT_TRUE(session) << session.error().text;
  std::vector<model::Keyframe> keyframes = rig::sim::ToKeyframes(*session);
  const target::Geometry geometry(session->target);
  const calib::RayGrid rays(session->camera);
  const auto one = EstimateScene(keyframes, geometry, rays, {});
  ASSERT_TRUE(one) << one.error().text;
  for (int i = 1; i < 9; ++i) keyframes.push_back(keyframes.front());
  const auto nine = EstimateScene(keyframes, geometry, rays, {});
  ASSERT_TRUE(nine) << nine.error().text;
  EXPECT_EQ(nine->estimate.distinct_views, 1);
  EXPECT_EQ(nine->estimate.views, 9);
  ASSERT_EQ(nine->estimate.lights.size(), one->estimate.lights.size());
  for (std::size_t l = 0; l < one->estimate.stat.lights.size(); ++l) {
    const double ratio =
        nine->estimate.stat.lights[l].direction / one->estimate.stat.lights[l].direction;
    EXPECT_GT(ratio, 0.8);
    EXPECT_LT(ratio, 1.25);
  }
}

// The same pictures a million times darker, as of a weak lamp with a long exposure.
TEST(Levels, DarkPicturesGiveTheSameLights) {
  rig::sim::SyntheticConfig config = SmallScene(0.002);
  const auto session = rig::sim::SynthesizeInMemory(config);
  ASSERT_TRUE(session) << session.error().text;
  std::vector<model::Keyframe> keyframes = rig::sim::ToKeyframes(*session);
  const target::Geometry geometry(session->target);
  const calib::RayGrid rays(session->camera);
  const auto bright = EstimateScene(keyframes, geometry, rays, {});
  ASSERT_TRUE(bright) << bright.error().text;
  const double factor = std::exp2(-20.0);
  for (model::Keyframe& keyframe : keyframes) keyframe.image.radiance *= factor;
  const auto dark = EstimateScene(keyframes, geometry, rays, {});
  ASSERT_TRUE(dark) << dark.error().text;
  ASSERT_EQ(dark->estimate.lights.size(), 2u);
  EXPECT_LT(WorstDirection(dark->estimate, LightsOf(config)), 0.1);
  EXPECT_NEAR(dark->estimate.rms / bright->estimate.rms / factor, 1.0, 0.05);
  for (std::size_t l = 0; l < 2; ++l)
    EXPECT_NEAR(dark->estimate.lights[l].specular_product[0] /
                    bright->estimate.lights[l].specular_product[0],
                factor, 0.01 * factor);
}

// Of two estimates of one scene, the second in W's coordinates times `unit` plus `shift`: that the
// lights, their sigmas and what they are seen on are the same.
void ExpectSameLights(const Estimate& a, const Estimate& b, double unit,
                      const Eigen::Vector3d& shift) {
  ASSERT_EQ(a.lights.size(), 2u);
  ASSERT_EQ(b.lights.size(), 2u);
  for (std::size_t l = 0; l < 2; ++l) {
    const LightEstimate &x = a.lights[l], &y = b.lights[l];
    EXPECT_LT((y.direction_at_reference - x.direction_at_reference).norm(),
              0.01 * x.direction_sigma);
    ASSERT_TRUE(x.position && y.position);
    const double sigma = std::sqrt(x.position_covariance->trace());
    EXPECT_LT(((*y.position - shift) / unit - *x.position).norm(), 0.01 * sigma);
    EXPECT_NEAR(std::sqrt(y.position_covariance->trace()) / unit, sigma, 0.01 * sigma);
  }
  EXPECT_NEAR(b.reflectance.lobes[0].shape, a.reflectance.lobes[0].shape,
              0.01 * a.sigma.lobes[0].shape.value());
  EXPECT_NEAR(b.rms, a.rms, 1e-4 * a.rms);
}

rig::sim::SyntheticConfig InUnits(double unit) {
  rig::sim::SyntheticConfig config = SmallScene(0.002);
  config.target = calib::SphereShape{50.0 * unit};
  config.motion.distance *= unit;
  for (rig::sim::LightSpec& light : LightsOf(config)) light.distance = *light.distance * unit;
  return config;
}

// Metres or micrometres: no length is compared with a number of its own.
TEST(Units, MetresAndMicrometresGiveTheSameLights) {
  const auto millimetres = rig::sim::SynthesizeInMemory(InUnits(1.0));
  ASSERT_TRUE(millimetres) << millimetres.error().text;
  const auto expected = EstimateFrom(*millimetres);
  ASSERT_TRUE(expected) << expected.error().text;
  for (const double unit : {1e-3, 1e3}) {
    const auto session = rig::sim::SynthesizeInMemory(InUnits(unit));
    ASSERT_TRUE(session) << session.error().text;
    const auto output = EstimateFrom(*session);
    ASSERT_TRUE(output) << output.error().text;
    const Estimate &a = expected->estimate, &b = output->estimate;
    ExpectSameLights(a, b, unit, Eigen::Vector3d::Zero());
    // Intensities are irradiances at W's origin, which is the same place.
    EXPECT_NEAR(b.lights[1].light.intensity, a.lights[1].light.intensity,
                0.01 * a.lights[1].intensity_sigma.value());
    for (std::size_t l = 0; l < 2; ++l)
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(b.lights[l].diffuse_product[c], a.lights[l].diffuse_product[c],
                    0.01 * a.lights[l].diffuse_product_sigma[c]);
  }
}

// W's origin 100 radii from the target, much further than the lights.
TEST(Origin, FarFromTheTargetTheLightsAreWhereTheyWere) {
  const auto session = rig::sim::SynthesizeInMemory(SmallScene(0.002));
  ASSERT_TRUE(session) << session.error().text;
  const auto expected = EstimateFrom(*session);
  ASSERT_TRUE(expected) << expected.error().text;
  const Eigen::Vector3d shift(3000.0, -2400.0, 3200.0);
  std::vector<model::Keyframe> keyframes = rig::sim::ToKeyframes(*session);
  for (model::Keyframe& keyframe : keyframes) {
    keyframe.X_WC.translation += shift;
    keyframe.X_WT.translation += shift;
  }
  const auto output = EstimateScene(keyframes, target::Geometry(session->target),
                                    calib::RayGrid(session->camera), {});
  ASSERT_TRUE(output) << output.error().text;
  // What is said about W's origin is about another place: the order of the lights may differ.
  Estimate moved = output->estimate;
  if (moved.lights.size() == 2 && moved.lights[0].direction_at_reference.dot(
                                      expected->estimate.lights[0].direction_at_reference) < 0.9)
    std::swap(moved.lights[0], moved.lights[1]);
  ExpectSameLights(expected->estimate, moved, 1.0, shift);
  for (const LightEstimate& light : moved.lights)
    EXPECT_LT(AngleDeg(light.light.direction, *light.position), 1e-6);
}

// Light and camera on opposite sides: a rough board then looks like a smooth one that reflects
// less.
TEST(Sigmas, ABoardThatMayBeRoughSaysSo) {
  rig::sim::SyntheticConfig config =
      SmallBall({{.direction = {-0.74, 0.33, 0.59}, .distance = {}, .intensity = 1.0}},
                Glossy(0.1, 0.6, 0.3));
  config.target = calib::PlaneShape{160.0, 120.0};
  config.motion.kind = rig::sim::MotionKind::kTable;
  config.motion.tilt_deg = 17.0;
  config.motion.elevation_deg = 49.0;
  auto& material = std::get<model::Reflectance>(config.reflectance);
  material.diffuse_model = model::DiffuseModel::kOrenNayar;
  material.roughness = DegToRad(30.0);
  const auto session = rig::sim::SynthesizeInMemory(config);
  ASSERT_TRUE(session) << session.error().text;
  const auto output = EstimateFrom(*session);
  ASSERT_TRUE(output) << output.error().text;
  const Estimate& e = output->estimate;
  ASSERT_EQ(e.lights.size(), 1u);
  EXPECT_EQ(e.reflectance.diffuse_model, model::DiffuseModel::kLambert);
  EXPECT_NE(std::find(e.weak.begin(), e.weak.end(), "diffuse against roughness: Lambert was taken"),
            e.weak.end());
  for (int c = 0; c < 3; ++c) {
    const double truth = material.albedo[c] * 0.6 * session->scene.lights[0].intensity;
    const double error = std::abs(e.lights[0].diffuse_product[c] - truth);
    EXPECT_LT(error, 3.0 * e.lights[0].diffuse_product_sigma[c]);
    EXPECT_GT(error, 0.1 * truth) << "too small a difference to tell anything";
  }
}

// All quantities that the two have, in sigmas; the lights in their order of intensity.
double WorstInSigmas(const Estimate& e, const rig::sim::SyntheticSession& session) {
  double worst = 0.0;
  const auto take = [&](double error, double sigma) {
    worst = std::max(worst, std::abs(error) / sigma);
  };
  const model::Reflectance& truth = session.scene.reflectance;
  for (std::size_t i = 0; i < e.lights.size(); ++i) {
    const model::Light& light = session.scene.lights[i];
    const LightEstimate& found = e.lights[i];
    take(DegToRad(AngleDeg(found.light.direction, light.direction)), found.direction_sigma);
    take(found.light.inverse_distance - light.inverse_distance, found.inverse_distance_sigma);
    take(found.specular_product[0] - truth.lobes[0].strength * light.intensity,
         found.specular_product_sigma[0]);
    for (int c = 0; c < 3; ++c)
      take(found.diffuse_product[c] - truth.albedo[c] * truth.diffuse * light.intensity,
           found.diffuse_product_sigma[c]);
  }
  for (int c = 0; c < 3; ++c)
    take(e.ambient_product[c] - truth.albedo[c] * truth.ambient, e.ambient_product_sigma[c]);
  take(e.reflectance.lobes[0].shape - truth.lobes[0].shape, e.sigma.lobes[0].shape.value_or(0.0));
  return worst;
}

// One thing each that the model does not have.
TEST(Sigmas, CoverWhatTheModelLeavesOut) {
  struct Case {
    const char* name;
    std::function<void(rig::sim::SyntheticConfig&)> scene;
    std::function<void(rig::sim::SyntheticSession&)> pictures;
    double most = 4.0;  // sigmas
  };
  const auto nothing = [](auto&) {};
  const std::vector<Case> cases = {
      {"pixels that average over less",
       [](rig::sim::SyntheticConfig& c) {
         c.samples_per_side = 3;
         c.sensor.noise_relative = 0.0;
       },
       nothing},
      {"a light half a radius above the surface",
       [](rig::sim::SyntheticConfig& c) { LightsOf(c)[0].distance = 75.0; }, nothing},
      {"a pattern of 5 %", nothing,
       [](rig::sim::SyntheticSession& s) {
         for (rig::sim::SyntheticFrame& frame : s.frames)
           for (int row = 0; row < frame.image.rows; ++row)
             for (int column = 0; column < frame.image.cols; ++column)
               if (std::sin(0.4 * row + 2.0 * std::sin(0.3 * column)) > 0.6)
                 for (int c = 0; c < 3; ++c) {
                   std::uint16_t& v = frame.image.at<cv::Vec3w>(row, column)[c];
                   v = static_cast<std::uint16_t>(6000.0 + 0.95 * (v - 6000.0));
                 }
       },
       5.0},  // it is the same in every view, which sigma knows only in part
  };
  for (const Case& one : cases) {
    SCOPED_TRACE(one.name);
    rig::sim::SyntheticConfig config = TwoLightBall(4, 0.002, 0.1);
    one.scene(config);
    auto session = rig::sim::SynthesizeInMemory(config);
    ASSERT_TRUE(session) << session.error().text;
    one.pictures(*session);
    const auto output = EstimateFrom(*session);
    ASSERT_TRUE(output) << output.error().text;
    ASSERT_EQ(output->estimate.lights.size(), session->scene.lights.size());
    EXPECT_LT(WorstInSigmas(output->estimate, *session), one.most);
  }
}

// What the halves of the pictures disagree about must be in sigma_total; the plain statistics of
// 1e5 pixels cannot know of it.
TEST(Sigmas, TotalCoversWhatTheModelLacks) {
  rig::sim::SyntheticConfig config = SmallScene(0.0005);
  const auto session = rig::sim::SynthesizeInMemory(config);
  ASSERT_TRUE(session) << session.error().text;
  std::vector<model::Keyframe> keyframes = rig::sim::ToKeyframes(*session);
  // Vignetting that nobody told of: 4 % darker at the picture's corner.
  for (model::Keyframe& keyframe : keyframes) {
    cv::Mat& image = keyframe.image.radiance;
    for (int row = 0; row < image.rows; ++row)
      for (int i = 0; i < image.cols * image.channels(); ++i) {
        const int column = i / image.channels();
        const double x = (column - 59.5) / 59.5, y = (row - 44.5) / 59.5;
        image.ptr<float>(row)[i] *= static_cast<float>(1.0 - 0.025 * (x * x + y * y));
      }
  }
  const auto output = EstimateScene(keyframes, target::Geometry(session->target),
                                    calib::RayGrid(session->camera), {});
  ASSERT_TRUE(output) << output.error().text;
  const Estimate& e = output->estimate;
  ASSERT_EQ(e.lights.size(), 2u);
  for (std::size_t l = 0; l < 2; ++l) {
    const double truth = 0.4 * 0.6 * LightsOf(config)[l].intensity;
    const double error = std::abs(e.lights[l].diffuse_product[0] - truth);
    EXPECT_LT(error, 4.0 * e.lights[l].diffuse_product_sigma[0]);
    EXPECT_GT(error, 4.0 * e.stat.lights[l].diffuse_product[0])
        << "too small a fault to tell anything";
  }
}

}  // namespace
}  // namespace turnlight::estimator
