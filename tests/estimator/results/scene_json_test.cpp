// Proves that scenes and starts are read as documented, that what does not fit is refused by name,
// that a written truth reads back to the same bits, and that readers keep to the rule for new keys
// (result_json.h). Does not prove that a result.json written by the program reads back;
// result_json_test does.
#include "estimator/results/scene_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "base/angles.h"

namespace turnlight::estimator::results {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const std::string kReflectance =
    R"("reflectance": {"model": "phong", "albedo": [0.2, 0.4, 0.6], "ambient": 0.1, "diffuse": 0.5,
       "specular": 0.3, "shininess": 40})";

std::string WithLight(const std::string& light) {
  return R"({"lights": [)" + light + "], " + kReflectance + "}";
}

std::string SceneError(const std::string& text) {
  const auto scene = ParseScene(text, "truth.json");
  return scene ? "accepted" : scene.error().text;
}

TEST(SceneJson, ReadsATruth) {
  const auto scene = ParseScene(
      WithLight(R"({"direction": [0, 3, 4], "position": [0, 300, 400], "intensity": 0.8})"), "t");
  ASSERT_TRUE(scene) << scene.error().text;
  ASSERT_EQ(scene->lights.size(), 1u);
  EXPECT_NEAR((scene->lights[0].direction - Eigen::Vector3d(0, 0.6, 0.8)).norm(), 0.0, 1e-15);
  EXPECT_DOUBLE_EQ(scene->lights[0].inverse_distance, 1.0 / 500.0);
  EXPECT_EQ(scene->lights[0].intensity, 0.8);
  EXPECT_EQ(scene->lights[0].color, Eigen::Vector3d::Ones());
  EXPECT_EQ(scene->reflectance.albedo, Eigen::Vector3d(0.2, 0.4, 0.6));
  EXPECT_EQ(scene->reflectance.lobes[0].shape, 40.0);
  EXPECT_EQ(scene->reflectance.lobes[0].model, model::SpecularModel::kPhong);
}

TEST(SceneJson, NullPositionIsADistantLight) {
  const auto scene =
      ParseScene(WithLight(R"({"direction": [0, 0, 2], "position": null, "intensity": 1})"), "t");
  ASSERT_TRUE(scene) << scene.error().text;
  EXPECT_EQ(scene->lights[0].inverse_distance, 0.0);
  EXPECT_EQ(scene->lights[0].direction, Eigen::Vector3d::UnitZ());
}

TEST(SceneJson, LightsAloneAreAStartButNoScene) {
  const std::string text =
      R"({"lights": [{"direction": [0, 0, 1], "position": null}], "note": "by eye"})";
  const auto guess = ParseInitialGuess(text, "truth.json");
  ASSERT_TRUE(guess) << guess.error().text;
  EXPECT_EQ(guess->lights.size(), 1u);
  EXPECT_FALSE(guess->has_intensities);
  EXPECT_FALSE(guess->reflectance);
  EXPECT_THAT(SceneError(text),
              AllOf(HasSubstr("truth.json: lights/0/intensity"), HasSubstr("rendering needs it")));
  EXPECT_THAT(SceneError(R"({"lights": [{"direction": [0, 0, 1], "intensity": 1}]})"),
              AllOf(HasSubstr("truth.json: reflectance"), HasSubstr("--initial")));
}

TEST(SceneJson, DirectionAndPositionMustAgreeInAScene) {
  // 0.2 degree apart, at 500.
  const std::string light =
      R"({"direction": [0, 0, 1], "position": [1.7453, 0, 499.997], "intensity": 1})";
  EXPECT_THAT(SceneError(WithLight(light)),
              AllOf(HasSubstr("lights/0/position"), HasSubstr("0.2 degrees"), HasSubstr("0.1")));
  const auto guess = ParseInitialGuess(WithLight(light), "t");
  ASSERT_TRUE(guess) << guess.error().text;
  EXPECT_EQ(guess->lights[0].direction, Eigen::Vector3d::UnitZ());
  EXPECT_NEAR(guess->lights[0].inverse_distance, 1.0 / 500.0, 1e-9);
  EXPECT_THAT(SceneError(WithLight(R"({"direction": [0, 0, 1], "position": [0, 0, 500],
                                       "inverse_distance": 0.003, "intensity": 1})")),
              HasSubstr("lights/0/inverse_distance"));
}

TEST(SceneJson, RefusalsNameTheKey) {
  EXPECT_THAT(SceneError(WithLight(R"({"direction": [0, 0, 0], "intensity": 1})")),
              HasSubstr("lights/0/direction"));
  EXPECT_THAT(SceneError(WithLight(R"({"direction": [0, 0, 1], "position": [0, 0, 0],
                                       "intensity": 1})")),
              HasSubstr("lights/0/position"));
  EXPECT_THAT(SceneError(WithLight(R"({"direction": [0, 0, 1], "intensity": -1})")),
              HasSubstr("lights/0/intensity"));
  EXPECT_THAT(SceneError(WithLight(R"({"direction": [0, 0, 1], "intensity": 1, "watts": 5})")),
              AllOf(HasSubstr("lights/0/watts"), HasSubstr("unknown key")));
  EXPECT_THAT(SceneError(R"({"lights": [], "reflectance": {"model": "velvet"}})"),
              AllOf(HasSubstr("reflectance/model"), HasSubstr("blinn-phong")));
  EXPECT_THAT(SceneError(R"({"format": "turnlight-session"})"), HasSubstr("turnlight-result"));
  EXPECT_THAT(SceneError("{"), HasSubstr("not valid JSON"));
  EXPECT_THAT(SceneError("[]"), HasSubstr("object"));
}

TEST(SceneJson, ShininessMayBeMissingOnlyWithoutALobe) {
  const std::string head =
      R"({"lights": [], "reflectance": {"albedo": [1, 1, 1], "ambient": 0, "diffuse": 1, )";
  EXPECT_EQ(SceneError(head + R"("model": "lambert"}})"), "accepted");
  EXPECT_EQ(SceneError(head + R"("model": "none", "specular": 0, "shininess": null}})"),
            "accepted");
  EXPECT_EQ(SceneError(head + R"("model": "phong", "specular": 0}})"), "accepted");
  EXPECT_THAT(SceneError(head + R"("model": "phong", "specular": 0.1}})"),
              HasSubstr("reflectance/shininess"));
  EXPECT_THAT(SceneError(head + R"("model": "none", "specular": 0.1}})"),
              HasSubstr("reflectance/specular"));
  EXPECT_THAT(SceneError(head + R"("model": "none", "roughness_deg": 20}})"),
              HasSubstr("reflectance/roughness_deg"));
}

TEST(SceneJson, FreeKeysAreAllowed) {
  EXPECT_EQ(SceneError(R"({"x-lab": 1, "lights": [{"direction": [0, 0, 1], "intensity": 1,
      "x-lamp": "B"}], )" +
                       kReflectance + "}"),
            "accepted");
}

TEST(SceneJson, TruthRoundTripsToTheSameBits) {
  model::Scene scene;
  scene.lights.push_back({Eigen::Vector3d(0.3, -0.2, 0.7).normalized(), 1.0 / 3.0e3, 0.7,
                          Eigen::Vector3d(1.0, 0.9, 0.8)});
  scene.lights.push_back(
      {Eigen::Vector3d(-0.1, 0.55, 0.3).normalized(), 0.0, 1.0 / 3.0, {1, 1, 1}});
  scene.reflectance.albedo = {0.1, 1.0 / 3.0, 0.9};
  scene.reflectance.ambient = 0.07;
  scene.reflectance.lobes[0].strength = 0.21;
  scene.reflectance.lobes[0].shape = 33.3;
  scene.reflectance.lobes[0].model = model::SpecularModel::kBlinnPhong;
  scene.reflectance.diffuse_model = model::DiffuseModel::kOrenNayar;
  scene.reflectance.roughness = DegToRad(20.0);
  const auto back = ParseScene(TruthToJson(scene, "made up"), "t");
  ASSERT_TRUE(back) << back.error().text;
  ASSERT_EQ(back->lights.size(), 2u);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(back->lights[i].direction, scene.lights[i].direction);
    EXPECT_EQ(back->lights[i].inverse_distance, scene.lights[i].inverse_distance);
    EXPECT_EQ(back->lights[i].intensity, scene.lights[i].intensity);
    EXPECT_EQ(back->lights[i].color, scene.lights[i].color);
  }
  EXPECT_EQ(back->reflectance.albedo, scene.reflectance.albedo);
  EXPECT_EQ(back->reflectance.ambient, scene.reflectance.ambient);
  EXPECT_EQ(back->reflectance.lobes[0].strength, scene.reflectance.lobes[0].strength);
  EXPECT_EQ(back->reflectance.lobes[0].shape, scene.reflectance.lobes[0].shape);
  EXPECT_EQ(back->reflectance.lobes[0].model, scene.reflectance.lobes[0].model);
  EXPECT_EQ(back->reflectance.diffuse_model, scene.reflectance.diffuse_model);
  EXPECT_NEAR(back->reflectance.roughness, scene.reflectance.roughness, 1e-15);
}

TEST(SceneJson, LobesAndColoursRoundTrip) {
  model::Scene scene;
  scene.lights.push_back({Eigen::Vector3d::UnitZ(), 0.0, 1.0, {1, 1, 1}});
  model::Reflectance& r = scene.reflectance;
  r.lobes[0] = {model::SpecularModel::kGgx, 0.21, 0.12, 0.04};
  r.ambient_colour = {1.0, 0.5, 0.25};
  r.specular_colour = {0.5, 1.0, 0.75};
  r.diffuse_model = model::DiffuseModel::kCoated;
  for (const bool two : {false, true}) {
    if (two) r.lobes[1] = {model::SpecularModel::kPhong, 0.1, 7.0};
    const auto back = ParseScene(TruthToJson(scene), "t");
    ASSERT_TRUE(back) << back.error().text;
    for (std::size_t k = 0; k < model::kMostLobes; ++k) {
      EXPECT_EQ(back->reflectance.lobes[k].model, r.lobes[k].model);
      EXPECT_EQ(back->reflectance.lobes[k].strength, r.lobes[k].strength);
      EXPECT_EQ(back->reflectance.lobes[k].shape, r.lobes[k].shape);
      EXPECT_EQ(back->reflectance.lobes[k].f0, r.lobes[k].f0);
    }
    EXPECT_EQ(back->reflectance.ambient_colour, r.ambient_colour);
    EXPECT_EQ(back->reflectance.specular_colour, r.specular_colour);
    EXPECT_EQ(back->reflectance.diffuse_model, r.diffuse_model);
  }
}

TEST(SceneJson, FactorsAndHarmonicsRoundTrip) {
  model::Scene scene;
  scene.lights.resize(2);
  scene.lights[1].factors = {0.9, 1.05, 1.05};
  for (int j = 0; j < model::kHarmonics; ++j) {
    scene.reflectance.harmonics[j] = 0.01 * (j - 3);
    scene.reflectance.shading[j] = 0.02 * (j - 5);
  }
  const auto back = ParseScene(TruthToJson(scene), "t");
  ASSERT_TRUE(back) << back.error().text;
  EXPECT_TRUE(back->lights[0].factors.empty());
  EXPECT_EQ(back->lights[1].factors, scene.lights[1].factors);
  EXPECT_EQ(back->reflectance.harmonics, scene.reflectance.harmonics);
  EXPECT_EQ(back->reflectance.shading, scene.reflectance.shading);
}

// A lobe without strength has no width: what is less than any lobe's is the least.
TEST(SceneJson, ALobeWithoutStrengthRoundTrips) {
  model::Scene scene;
  model::Lobe& lobe = scene.reflectance.lobes[0];
  for (const double alpha : {0.0, 0.2}) {
    lobe = {model::SpecularModel::kGgx, 0.0, alpha, 1.0};
    const auto back = ParseScene(TruthToJson(scene), "t");
    ASSERT_TRUE(back) << back.error().text;
    EXPECT_EQ(back->reflectance.lobes[0].shape,
              std::max(alpha, model::FactsOf(lobe.model).least_shape));
    EXPECT_EQ(TruthToJson(*ParseScene(TruthToJson(*back), "t")), TruthToJson(*back));
  }
}

TEST(SceneJson, RefusalsOfLobesNameTheKey) {
  const auto of = [](const std::string& keys) {
    return SceneError(R"({"lights": [], "reflectance": {"model": "ggx", "albedo": [1, 1, 1],
      "ambient": 0, "diffuse": 1, )" +
                      keys + "}}");
  };
  EXPECT_THAT(of(R"("specular": 0.1)"), HasSubstr("reflectance/alpha"));
  EXPECT_THAT(of(R"("specular": 0.1, "alpha": 7)"), HasSubstr("reflectance/alpha"));
  for (const char* f0 : {"0", "0.009", "2"})
    EXPECT_THAT(of(R"("specular": 0.1, "alpha": 0.1, "f0": )" + std::string(f0)),
                testing::AllOf(HasSubstr("reflectance/f0"), HasSubstr("0.01")))
        << f0;
  EXPECT_THAT(of(R"("lobes": [{"model": "none", "specular": 0}])"),
              HasSubstr("reflectance/lobes/0/model"));
  EXPECT_THAT(of(R"("lobes": [{"model": "phong", "specular": 1, "alpha": 3}])"),
              HasSubstr("reflectance/lobes/0/shininess"));
  const std::string lobe = R"({"model": "phong", "specular": 1, "shininess": 3})";
  EXPECT_THAT(of("\"lobes\": [" + lobe + "," + lobe + "," + lobe + "]"),
              HasSubstr("3 lobes, allowed are at most 2"));
}

TEST(SceneJson, ReadsAResultExactly) {
  const std::string text = R"({"format": "turnlight-result", "version": 1, "session": "s",
    "model": {"lights": 1, "near": [true], "diffuse": "oren-nayar", "specular": "none"},
    "lights": [{"direction": [0, 0, 1], "direction_sigma_deg": 0.1, "inverse_distance": 0.002,
                "distance": 500.0, "position": [0, 0, 500.001], "intensity": 1.0,
                "intensity_sigma": null}],
    "reflectance": {"albedo": [1, 0.5, 0.5], "ambient": 0.1, "diffuse": 0.6, "specular": 0,
                    "shininess": null, "roughness_deg": 20, "lobe": null, "sigma": {}},
    "notes": []})";
  const auto scene = ParseScene(text, "result.json");
  ASSERT_TRUE(scene) << scene.error().text;
  EXPECT_EQ(scene->lights[0].inverse_distance, 0.002);
  EXPECT_EQ(scene->reflectance.lobes[0].model, model::SpecularModel::kNone);
  EXPECT_EQ(scene->reflectance.diffuse_model, model::DiffuseModel::kOrenNayar);
  EXPECT_DOUBLE_EQ(scene->reflectance.roughness, DegToRad(20.0));
  const auto guess = ParseInitialGuess(text, "result.json");
  ASSERT_TRUE(guess) << guess.error().text;
  EXPECT_TRUE(guess->has_intensities);
  EXPECT_TRUE(guess->reflectance);
  EXPECT_THAT(SceneError(R"({"format": "turnlight-result", "version": 2})"), HasSubstr("version"));
}

// A file of a newer turnlight, with keys that ours does not know in every place that it reads.
TEST(SceneJson, AResultMayHaveGainedKeys) {
  const std::string text = R"({"format": "turnlight-result", "version": 1, "correlation": [[1]],
    "model": {"diffuse": "lambert", "specular": "phong", "basis": "none"},
    "lights": [{"direction": [0, 0, 1], "inverse_distance": 0, "intensity": 1, "extent": 2,
                "x-lamp": "B"}],
    "reflectance": {"albedo": [1, 1, 1], "ambient": 0.1, "diffuse": 0.6, "specular": 0.2,
                    "shininess": 30, "anisotropy": 0.1}, "x-lab": 1})";
  const auto scene = ParseScene(text, "result.json");
  ASSERT_TRUE(scene) << scene.error().text;
  EXPECT_EQ(scene->reflectance.lobes[0].shape, 30.0);
  const auto guess = ParseInitialGuess(text, "result.json");
  ASSERT_TRUE(guess) << guess.error().text;
  EXPECT_EQ(guess->lights.size(), 1u);
}

// What an estimate did not determine is null: a guess does without it, a picture cannot.
TEST(SceneJson, NullsOfAResult) {
  const std::string text = R"({"format": "turnlight-result", "version": 1,
    "model": {"diffuse": "lambert", "specular": "phong"},
    "lights": [{"direction": [0, 0, 1], "inverse_distance": 0, "intensity": 1},
               {"direction": [0, 1, 0], "inverse_distance": 0, "intensity": INTENSITY}],
    "reflectance": {"albedo": ALBEDO, "ambient": 0.1, "diffuse": DIFFUSE, "specular": 0.3,
                    "shininess": 30}})";
  const auto with = [&](std::string intensity, std::string albedo, std::string diffuse) {
    std::string out = text;
    for (const auto& [name, value] :
         {std::pair("INTENSITY", intensity), {"ALBEDO", albedo}, {"DIFFUSE", diffuse}})
      out.replace(out.find(name), std::string(name).size(), value);
    return out;
  };
  const std::string words = "null: that estimate did not determine it";
  EXPECT_EQ(SceneError(with("0.5", "[1, 1, 1]", "0.4")), "accepted");
  EXPECT_THAT(SceneError(with("null", "[1, 1, 1]", "0.4")),
              HasSubstr("lights/1/intensity: " + words));
  EXPECT_THAT(SceneError(with("0.5", "[1, null, 1]", "0.4")),
              HasSubstr("reflectance/albedo: " + words));
  EXPECT_THAT(SceneError(with("0.5", "[1, 1, 1]", "null")),
              HasSubstr("reflectance/diffuse: " + words));
  const auto guess = ParseInitialGuess(with("null", "[1, null, 1]", "null"), "result.json");
  ASSERT_TRUE(guess) << guess.error().text;
  EXPECT_EQ(guess->lights.size(), 2u);
  EXPECT_FALSE(guess->has_intensities);
  EXPECT_FALSE(guess->reflectance);
}

// Nothing but what says the scene is needed; what is needed and misspelt is named.
TEST(SceneJson, AResultMayLackWhatIsOptional) {
  const std::string head =
      R"({"format": "turnlight-result", "version": 1,
          "model": {"diffuse": "lambert", "specular": "none"},
          "reflectance": {"albedo": [1, 1, 1], "ambient": 0.1, "diffuse": 0.6}, "lights": [)";
  EXPECT_EQ(
      SceneError(head + R"({"direction": [0, 0, 1], "inverse_distance": 0, "intensity": 1}]})"),
      "accepted");
  EXPECT_THAT(
      SceneError(head + R"({"direction": [0, 0, 1], "inverse_distence": 0, "intensity": 1}]})"),
      AllOf(HasSubstr("lights/0/inverse_distence"), HasSubstr("\"inverse_distance\"")));
}

}  // namespace
}  // namespace turnlight::estimator::results
