// Proves: predictions are the scene model's own shades for every model of reflectance, without what
// a light's mask says it does not light. Does not prove means over footprints
// (observations_test, normal_equations_test).
#include "estimator/solve/prediction.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/estimator/random_observations.h"

namespace turnlight::estimator::solve {
namespace {

TEST(Predict, IsTheShadeOfEachPoint) {
  for (const auto specular : {model::SpecularModel::kPhong, model::SpecularModel::kBlinnPhong,
                              model::SpecularModel::kNone})
    for (const auto diffuse : {model::DiffuseModel::kLambert, model::DiffuseModel::kOrenNayar}) {
      model::Scene scene = TwoLights(0.0, 0.6);
      scene.reflectance.lobes[0].model = specular;
      scene.reflectance.diffuse_model = diffuse;
      scene.reflectance.roughness = 0.4;
      const RandomObservations random(500, 3, 21);
      const Prediction model = Predict(random.observations, scene, {});
      ASSERT_EQ(model.size(), 3u);
      for (std::size_t i = 0; i < random.points.size(); ++i) {
        const RandomPoint& p = random.points[i];
        bool at_terminator = false;  // where single precision may see the other side
        for (const model::Light& light : scene.lights)
          at_terminator |= std::abs(p.normal.dot(light.Toward(p.position))) < 1e-3;
        if (at_terminator) continue;
        const Eigen::Vector3d expected = model::Shade(scene, p.position, p.normal, p.viewer);
        for (std::size_t c = 0; c < 3; ++c)
          EXPECT_NEAR(model[c][i], expected[static_cast<Eigen::Index>(c)], 1e-5);
      }
    }
}

TEST(Predict, LeavesOutWhatIsNotLit) {
  const model::Scene scene = TwoLights();
  const RandomObservations random(700, 1, 5);
  EvaluateOptions options;
  for (std::size_t l = 0; l < 2; ++l) {
    auto lit = std::make_shared<std::vector<std::uint8_t>>(random.observations.size(), 1);
    for (std::size_t i = 0; i < lit->size(); ++i) (*lit)[i] = (i + l) % 3 == 0 ? 0 : 1;
    options.shadows.lit.push_back(std::move(lit));
  }
  const Prediction model = Predict(random.observations, scene, options);
  for (std::size_t i = 0; i < random.points.size(); ++i) {
    model::LightMask visible = 0;
    for (std::size_t l = 0; l < 2; ++l)
      if ((*options.shadows.lit[l])[i] != 0) visible |= model::LightMask{1} << l;
    const RandomPoint& p = random.points[i];
    EXPECT_NEAR(model[0][i], model::Shade(scene, p.position, p.normal, p.viewer, visible)[0], 2e-5);
  }
}

}  // namespace
}  // namespace turnlight::estimator::solve
