// Proves: pictures that no usual model explains, with highlights, are estimated as photographs, and
// say so; renderings are not, and a matte surface is not; with other models asked for, neither.
#include "estimator/photograph_estimate.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "estimator/estimate.h"
#include "tests/estimator/photograph_ball.h"

namespace turnlight::estimator {
namespace {

const std::vector<Eigen::Vector3d> kTwo{{0.9, 0.3, 0.3}, {0.7, -0.6, 0.3}};

bool Has(const Estimate& estimate, const char* code) {
  return std::any_of(estimate.notes.begin(), estimate.notes.end(),
                     [&](const Note& note) { return note.code == code; });
}

EstimateOutput Estimated(const PhotographBall& ball, const EstimateOptions& options = {}) {
  auto output = EstimateScene(ball.keyframes, ball.geometry, ball.rays, options);
  EXPECT_TRUE(output) << output.error().text;
  return std::move(*output);
}

TEST(PhotographEstimate, OfASurfaceThatNoModelExplains) {
  const PhotographBall ball(GlossyScene(kTwo), 1, 0.05);
  EstimateOptions options;
  options.residuals_of = [](std::size_t) { return std::vector<std::size_t>{0}; };
  const EstimateOutput output = Estimated(ball, options);
  const Estimate& estimate = output.estimate;
  EXPECT_TRUE(Has(estimate, "photograph"));
  EXPECT_FALSE(Has(estimate, "count-uncertain"));
  ASSERT_EQ(estimate.lights.size(), 2u);
  for (const LightEstimate& light : estimate.lights) {
    EXPECT_LT(NearestDeg(light.light.direction, kTwo), 2.0 * RadToDeg(light.direction_sigma));
    EXPECT_FALSE(light.distance);
  }
  EXPECT_LT(estimate.rms, 0.02);
  EXPECT_FALSE(estimate.reflectance.shading.isZero(0.0));
  EXPECT_EQ(output.residuals.count(0), 1u);
}

TEST(PhotographEstimate, IsNotOfRenderings) {
  model::Scene scene = GlossyScene(kTwo);
  scene.reflectance.lobes = {model::Lobe{model::SpecularModel::kGgx, 0.05, 0.2, 1.0},
                             model::Lobe{}};
  const Estimate estimate = Estimated(PhotographBall(scene, 3, 0.0)).estimate;
  EXPECT_FALSE(Has(estimate, "photograph"));
  EXPECT_TRUE(estimate.reflectance.shading.isZero(0.0));
}

TEST(PhotographEstimate, IsNotOfAMatteSurface) {
  model::Scene scene = GlossyScene({kTwo[0]});
  model::SetLobeModel(scene.reflectance, model::SpecularModel::kNone);
  EXPECT_FALSE(Has(Estimated(PhotographBall(scene, 1, 0.05)).estimate, "photograph"));
}

TEST(PhotographEstimate, IsNotWhereOtherModelsAreAskedFor) {
  EstimateOptions options;
  options.model.specular = model::SpecularModel::kNone;
  EXPECT_FALSE(
      Has(Estimated(PhotographBall(GlossyScene(kTwo), 1, 0.05), options).estimate, "photograph"));
}

}  // namespace
}  // namespace turnlight::estimator
