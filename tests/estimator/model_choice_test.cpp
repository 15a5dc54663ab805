// Proves, on pictures of our own renderer of two lights on a glossy ball: what the user says about
// the model is done, and the ladder says so; what he leaves open is found: two lights, the lobe
// that the pictures were made with, or no light at all. Does not prove that the data decide as well
// on other scenes (bench/studies), or the words of the command line (tests/app/model_option_test).
#include <gtest/gtest.h>

#include <algorithm>

#include "estimator/estimate.h"
#include "tests/estimator/small_scene.h"

namespace turnlight::estimator {
namespace {

// Small pictures: what is decided here takes few pixels.
rig::sim::SyntheticConfig Ball(double noise, double ambient) {
  rig::sim::SyntheticConfig config = TwoLightBall(1, noise, ambient);
  config.motion.frames = 4;
  config.motion.step_deg = 90.0;
  config.camera = {.width = 60, .height = 45, .focal_px = 150.0, .distortion = {}};
  return config;
}

Result<EstimateOutput> EstimateWith(const rig::sim::SyntheticConfig& config,
                                    const model::ModelChoice& choice) {
  const auto session = rig::sim::SynthesizeInMemory(config);
  if (!session) return Forward(session);
  EstimateOptions options;
  options.model = choice;
  return EstimateFrom(*session, options);
}

// With so much noise that a model which does not fit is no reason to go on looking for lights.
Result<EstimateOutput> EstimateWith(const model::ModelChoice& choice) {
  return EstimateWith(Ball(0.02, 0.1), choice);
}

const model::Rung* Find(const Estimate& estimate, const std::string& name) {
  const auto at = std::find_if(estimate.ladder.rbegin(), estimate.ladder.rend(),
                               [&](const model::Rung& rung) { return rung.rung == name; });
  return at == estimate.ladder.rend() ? nullptr : &*at;
}

void ExpectAsAsked(const Estimate& estimate, const std::string& name, bool accepted) {
  const model::Rung* rung = Find(estimate, name);
  ASSERT_NE(rung, nullptr) << name;
  EXPECT_EQ(rung->accepted, accepted) << name;
  EXPECT_NE(rung->why.find("as asked for"), std::string::npos) << name << ": " << rung->why;
}

TEST(ModelChoice, LeftOpenTheDataDecide) {
  const auto output = EstimateWith({});
  ASSERT_TRUE(output) << output.error().text;
  const Estimate& e = output->estimate;
  EXPECT_EQ(e.lights.size(), 2u);
  EXPECT_EQ(e.reflectance.lobes[0].model, model::SpecularModel::kPhong);
  EXPECT_EQ(e.reflectance.diffuse_model, model::DiffuseModel::kLambert);
  for (const LightEstimate& light : e.lights) EXPECT_TRUE(light.near);
  for (const model::Rung& rung : e.ladder)
    EXPECT_EQ(rung.why.find("asked for"), std::string::npos) << rung.rung << ": " << rung.why;
}

TEST(ModelChoice, AsManyLightsAsAskedFor) {
  for (const int count : {1, 3}) {
    model::ModelChoice choice;
    choice.lights = count;
    const auto output = EstimateWith(choice);
    ASSERT_TRUE(output) << output.error().text;
    const Estimate& e = output->estimate;
    const model::Rung* rung = Find(e, "lights");
    ASSERT_NE(rung, nullptr);
    EXPECT_EQ(rung->accepted, static_cast<int>(e.lights.size()) == count) << rung->why;
    EXPECT_EQ(rung->why, std::to_string(count) + " were asked for, " +
                             std::to_string(e.lights.size()) + " could be fitted");
    // Fewer than there are can always be fitted.
    if (count == 1) {
      EXPECT_EQ(e.lights.size(), 1u);
    }
  }
}

void ExpectReflectanceAsAsked(model::SpecularModel specular, model::DiffuseModel diffuse) {
  model::ModelChoice choice;
  choice.specular = specular;
  choice.diffuse = diffuse;
  const auto output = EstimateWith(choice);
  ASSERT_TRUE(output) << output.error().text;
  const Estimate& e = output->estimate;
  EXPECT_EQ(e.reflectance.lobes[0].model, specular);
  EXPECT_EQ(e.reflectance.lobes[0].strength > 0.0, specular != model::SpecularModel::kNone);
  EXPECT_EQ(e.reflectance.diffuse_model, diffuse);
  ExpectAsAsked(e, "specular", specular != model::SpecularModel::kNone);
  ExpectAsAsked(e, "blinn-phong", specular == model::SpecularModel::kBlinnPhong);
  ExpectAsAsked(e, "oren-nayar", diffuse == model::DiffuseModel::kOrenNayar);
}

TEST(ModelChoice, NoHighlightAndARoughSurface) {
  ExpectReflectanceAsAsked(model::SpecularModel::kNone, model::DiffuseModel::kOrenNayar);
}

TEST(ModelChoice, BlinnPhongOnASmoothSurface) {
  ExpectReflectanceAsAsked(model::SpecularModel::kBlinnPhong, model::DiffuseModel::kLambert);
}

TEST(ModelChoice, ADistantLightHasNoDistance) {
  rig::sim::SyntheticConfig config = Ball(0.02, 0.1);
  LightsOf(config).pop_back();
  const auto open = EstimateWith(config, {});
  ASSERT_TRUE(open) << open.error().text;
  model::ModelChoice choice;
  choice.near = false;
  choice.lights = 1;
  const auto asked = EstimateWith(config, choice);
  ASSERT_TRUE(asked) << asked.error().text;
  ASSERT_EQ(open->estimate.lights.size(), 1u);
  EXPECT_TRUE(open->estimate.lights[0].near);
  EXPECT_TRUE(open->estimate.lights[0].distance && open->estimate.lights[0].position);
  ASSERT_EQ(asked->estimate.lights.size(), 1u);
  EXPECT_FALSE(asked->estimate.lights[0].near);
  EXPECT_FALSE(asked->estimate.lights[0].distance || asked->estimate.lights[0].position);
  ExpectAsAsked(asked->estimate, "near light 1", false);
}

// Two lamps too far for the pictures to tell how far: left open they are distant.
TEST(ModelChoice, NearLightsKeepTheirDistance) {
  rig::sim::SyntheticConfig config = Ball(0.005, 0.1);
  for (rig::sim::LightSpec& light : LightsOf(config)) light.distance = 1e6;
  const auto open = EstimateWith(config, {});
  ASSERT_TRUE(open) << open.error().text;
  model::ModelChoice choice;
  choice.near = true;
  const auto asked = EstimateWith(config, choice);
  ASSERT_TRUE(asked) << asked.error().text;
  ASSERT_EQ(open->estimate.lights.size(), 2u);
  ASSERT_EQ(asked->estimate.lights.size(), 2u);
  EXPECT_TRUE(asked->estimate.lights[0].near || asked->estimate.lights[1].near)
      << "the fit put both at infinity: nothing was asked of it here";
  for (std::size_t l = 0; l < 2; ++l) {
    EXPECT_FALSE(open->estimate.lights[l].near);
    const LightEstimate& light = asked->estimate.lights[l];
    // A light that the fit put at infinity has no distance, whatever was asked for.
    EXPECT_EQ(light.near, light.light.inverse_distance > 0.0);
    EXPECT_EQ(light.distance.has_value(), light.near);
    ExpectAsAsked(asked->estimate, "near light " + std::to_string(l + 1), light.near);
  }
}

// Two lamps whose distance pictures with noise tell only roughly.
TEST(ModelChoice, AKnownDistanceIsKeptAndNarrowsTheDirections) {
  rig::sim::SyntheticConfig config = Ball(0.02, 0.1);
  for (rig::sim::LightSpec& light : LightsOf(config)) light.distance = 400.0;
  model::ModelChoice choice;
  choice.near = true;
  choice.lights = 2;
  const auto open = EstimateWith(config, choice);
  ASSERT_TRUE(open) << open.error().text;
  choice.distance = model::DistanceRange{380.0, 420.0};
  const auto known = EstimateWith(config, choice);
  ASSERT_TRUE(known) << known.error().text;
  ASSERT_EQ(known->estimate.lights.size(), 2u);
  ASSERT_EQ(open->estimate.lights.size(), 2u);
  for (std::size_t l = 0; l < 2; ++l) {
    const LightEstimate& light = known->estimate.lights[l];
    ASSERT_TRUE(light.near && light.distance);
    EXPECT_GE(*light.distance, 380.0 * (1.0 - 1e-6));
    EXPECT_LE(*light.distance, 420.0 * (1.0 + 1e-6));
    // That of a uniform inverse distance, or less.
    EXPECT_LE(light.distance_sigma.value_or(1e9),
              420.0 * 420.0 * (1.0 / 380.0 - 1.0 / 420.0) / std::sqrt(12.0) * 1.001);
    EXPECT_GT(light.distance_sigma.value_or(0.0), 0.0);
    EXPECT_LE(light.direction_sigma, open->estimate.lights[l].direction_sigma * 1.001);
  }
}

// A range that the truth is not in is kept all the same.
TEST(ModelChoice, ADistanceThatIsSaidWronglyIsKept) {
  model::ModelChoice choice;
  choice.near = true;
  choice.distance = model::DistanceRange{5000.0, 6000.0};
  const auto asked = EstimateWith(choice);
  ASSERT_TRUE(asked) << asked.error().text;
  for (const LightEstimate& light : asked->estimate.lights) {
    ASSERT_TRUE(light.near && light.distance);
    EXPECT_GE(*light.distance, 5000.0 * (1.0 - 1e-6));
    EXPECT_LE(*light.distance, 6000.0 * (1.0 + 1e-6));
  }
}

TEST(ModelChoice, TheLobeIsThatOfThePictures) {
  for (const model::SpecularModel model :
       {model::SpecularModel::kPhong, model::SpecularModel::kBlinnPhong}) {
    rig::sim::SyntheticConfig config = Ball(0.004, 0.1);
    auto& reflectance = std::get<model::Reflectance>(config.reflectance);
    reflectance.lobes[0].model = model;
    reflectance.lobes[0].shape = 60.0;
    const auto output = EstimateWith(config, {});
    ASSERT_TRUE(output) << output.error().text;
    const Estimate& e = output->estimate;
    EXPECT_EQ(e.lights.size(), 2u);
    EXPECT_EQ(e.reflectance.lobes[0].model, model);
    EXPECT_NEAR(e.reflectance.lobes[0].shape, 60.0, 3.0);
    const model::Rung* rung = Find(e, "blinn-phong");
    ASSERT_NE(rung, nullptr);
    EXPECT_EQ(rung->accepted, model == model::SpecularModel::kBlinnPhong) << rung->why;
  }
}

TEST(ModelChoice, ColoursOfGreyPicturesAreRefusedInWords) {
  rig::sim::SyntheticConfig config = Ball(0.0, 0.1);
  std::get<model::Reflectance>(config.reflectance).albedo.setConstant(0.6);
  model::ModelChoice choice;
  choice.coloured = true;
  const auto output = EstimateWith(config, choice);
  ASSERT_TRUE(output) << output.error().text;
  const Estimate& e = output->estimate;
  ASSERT_EQ(e.channels, 1);
  const model::Rung* rung = Find(e, "colours");
  ASSERT_NE(rung, nullptr);
  EXPECT_FALSE(rung->accepted);
  EXPECT_NE(rung->why.find("one channel"), std::string::npos) << rung->why;
  EXPECT_TRUE(std::any_of(e.notes.begin(), e.notes.end(), [](const Note& note) {
    return note.code == "grey" && note.text.find("--model color=free") != std::string::npos;
  }));
}

TEST(ModelChoice, AmbientLightAloneIsNoLight) {
  rig::sim::SyntheticConfig config = Ball(0.01, 0.5);
  auto& reflectance = std::get<model::Reflectance>(config.reflectance);
  reflectance.diffuse = 0.0;
  reflectance.lobes[0].strength = 0.0;
  const auto output = EstimateWith(config, {});
  ASSERT_TRUE(output) << output.error().text;
  const Estimate& e = output->estimate;
  EXPECT_TRUE(e.lights.empty());
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(e.ambient_product[c], 0.5 * reflectance.albedo[c], 1e-3);
}

}  // namespace
}  // namespace turnlight::estimator
