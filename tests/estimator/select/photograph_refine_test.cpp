// Proves: what is reported of a photograph's lights comes with sigmas that hold their errors, with
// a budget that adds up; no distance is claimed of distant lights, one is of a near light seen from
// all around, and what the user says is done.
#include "estimator/select/photograph_refine.h"

#include <gtest/gtest.h>

#include "estimator/start/photograph_lights.h"
#include "estimator/uncertainty/uncertainty.h"
#include "tests/estimator/photograph_ball.h"

namespace turnlight::estimator::select {
namespace {

const std::vector<Eigen::Vector3d> kTwo{{0.9, 0.3, 0.3}, {0.7, -0.6, 0.3}};

struct Made {
  observe::Photograph photograph;
  Refined refined;
  std::vector<model::Rung> ladder;
};

Made Make(const model::Scene& scene, int views, const model::ModelChoice& choice = {}) {
  const PhotographBall ball(scene, views);
  Made out;
  out.photograph = *observe::TakePhotograph(ball.source(), ball.geometry, ball.rays);
  out.refined = RefinePhotograph(out.photograph.pixels,
                                 start::FindPhotographLights(out.photograph, choice).scene, 1.0,
                                 choice, out.ladder);
  return out;
}

TEST(RefinePhotograph, HasSigmasThatHold) {
  const Made made = Make(GlossyScene(kTwo), 1);
  ASSERT_EQ(made.refined.solution.scene.lights.size(), 2u);
  const uncertainty::Uncertainties sigmas = uncertainty::EstimateUncertainty(
      made.refined.solution, made.photograph.pixels, {0, 1}, 1.0, made.refined.splits);
  for (std::size_t l = 0; l < 2; ++l) {
    const double sigma = RadToDeg(sigmas.total.lights[l].direction);
    EXPECT_LT(NearestDeg(made.refined.solution.scene.lights[l].direction, kTwo), 2.0 * sigma);
    EXPECT_LT(sigma, 1.5);
    double sum = 0.0;
    for (const uncertainty::BudgetItem& item : sigmas.budget)
      sum += std::pow(RadToDeg(item.sigma.lights[l].direction), 2);
    EXPECT_NEAR(std::sqrt(sum), sigma, 1e-6 * sigma);
    EXPECT_FALSE(made.refined.near[l]);
  }
}

TEST(RefinePhotograph, DoesWhatTheUserSaysOfDistances) {
  model::ModelChoice choice;
  choice.near = false;
  EXPECT_FALSE(Make(GlossyScene({kTwo[0]}), 1, choice).refined.near[0]);
  model::Scene scene = GlossyScene({kTwo[0]});
  scene.lights[0].inverse_distance = 0.3;
  choice.near = true;
  const Made made = Make(scene, 4, choice);
  ASSERT_EQ(made.refined.near.size(), 1u);
  EXPECT_TRUE(made.refined.near[0]);
  EXPECT_NE(made.ladder.back().why.find("as asked for"), std::string::npos);
}

}  // namespace
}  // namespace turnlight::estimator::select
