// Proves: the errors of highlights on a ball are those of the closed form.
#include "estimator/uncertainty/photograph_errors.h"

#include <gtest/gtest.h>

#include "estimator/observe/observations.h"
#include "tests/estimator/photograph_ball.h"

namespace turnlight::estimator::uncertainty {
namespace {

TEST(ErrorsOfHighlights, AreThoseOfABall) {
  const PhotographBall ball(GlossyScene({{1.0, 0.0, 0.0}}));
  observe::Observations all = observe::BuildObservations(ball.keyframes, ball.geometry, ball.rays);
  model::Scene scene = GlossyScene({{1.0, 0.0, 0.0}, {0.6, 0.8, 0.0}});
  const PhotographErrors errors = ErrorsOfHighlights(all, scene);
  // In the middle a pixel is 7.4 / 420 wide, and the mirrored view turns by twice the normal, and
  // by the view's own turn, which is 1 / 420.
  const double turn = 2.0 * 7.4 / 420.0 + 1.0 / 420.0;
  EXPECT_NEAR(errors.place[0], 0.15 * turn, 0.03 * 0.15 * turn);
  EXPECT_LT(errors.distance[0].norm(), 0.02 * 0.08) << "the highlight is on the line to the light";
  // The normal is half way between view and light; from far away the highlight is at sin(26.6 deg)
  // beside the line to the light.
  EXPECT_NEAR(errors.distance[1].norm(), 0.02 * std::sin(DegToRad(26.57)), 0.02 * 0.08);
  EXPECT_NEAR(errors.distance[1].dot(scene.lights[1].direction), 0.0, 1e-9);
  scene.lights[1].inverse_distance = 0.1;
  EXPECT_EQ(ErrorsOfHighlights(all, scene).distance[1].norm(), 0.0);
}

}  // namespace
}  // namespace turnlight::estimator::uncertainty
