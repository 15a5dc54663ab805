// Proves: renderings of usual models are known as such from about their lights, with lobes that are
// not Phong's, colours and changing lights; a surface with smooth texture is not.
#include "estimator/start/usual_models.h"

#include <gtest/gtest.h>

#include "estimator/observe/radiance_statistics.h"
#include "estimator/observe/sampling.h"
#include "estimator/start/start_scene.h"
#include "tests/estimator/photograph_ball.h"

namespace turnlight::estimator::start {
namespace {

const std::vector<Eigen::Vector3d> kTwo{{0.9, 0.3, 0.3}, {0.7, -0.6, 0.3}};

bool Explained(const model::Scene& scene, double texture, int views = 4) {
  const PhotographBall ball(scene, views, texture);
  const observe::Observations all =
      observe::BuildObservations(ball.keyframes, ball.geometry, ball.rays);
  const Sample sample{observe::Subsample(all, 6000, 1, true), observe::EstimateNoise(all), {}};
  model::Scene lights = StartFromDirections(sample.pixels, kTwo);
  for (model::Light& light : lights.lights)
    light.direction = (light.direction + Eigen::Vector3d(0.0, 0.01, 0.0)).normalized();
  return UsualModelsExplain(sample, lights);
}

model::Scene OneLobe(model::SpecularModel lobe) {
  model::Scene scene = GlossyScene(kTwo);
  scene.reflectance.lobes = {model::Lobe{model::SpecularModel::kGgx, 0.05, 0.2, 1.0},
                             model::Lobe{}};
  model::SetLobeModel(scene.reflectance, lobe);
  return scene;
}

TEST(UsualModelsExplain, RenderingsOfThem) {
  for (const model::SpecularModel lobe :
       {model::SpecularModel::kPhong, model::SpecularModel::kBeckmann, model::SpecularModel::kGgx})
    EXPECT_TRUE(Explained(OneLobe(lobe), 0.0));
  model::Scene coloured = OneLobe(model::SpecularModel::kGgx);
  coloured.lights[1].color = {1.0, 0.7, 0.5};
  EXPECT_TRUE(Explained(coloured, 0.0));
}

TEST(UsualModelsExplain, NoSurfaceWithTexture) {
  EXPECT_FALSE(Explained(OneLobe(model::SpecularModel::kGgx), 0.03));
}

}  // namespace
}  // namespace turnlight::estimator::start
