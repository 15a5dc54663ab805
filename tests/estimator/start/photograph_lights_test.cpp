// Proves: from clipped highlights on a surface that departs from every model all lights are found,
// in one view and in several, as many as are asked for, the same whatever the order of what they
// start from. Real photographs: independent_photographs_test.
#include "estimator/start/photograph_lights.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/estimator/photograph_ball.h"

namespace turnlight::estimator::start {
namespace {

const std::vector<Eigen::Vector3d> kThree{{0.9, 0.3, 0.3}, {0.7, -0.6, 0.3}, {0.5, 0.2, -0.8}};

observe::Photograph Take(const PhotographBall& ball) {
  return *observe::TakePhotograph(ball.source(), ball.geometry, ball.rays);
}

void ExpectLights(const model::Scene& scene, const std::vector<Eigen::Vector3d>& directions,
                  double within_deg) {
  ASSERT_EQ(scene.lights.size(), directions.size());
  for (const model::Light& light : scene.lights)
    EXPECT_LT(NearestDeg(light.direction, directions), within_deg);
}

TEST(PhotographLights, AreAllFoundInOneView) {
  for (std::size_t lights = 1; lights <= 3; ++lights) {
    const std::vector<Eigen::Vector3d> directions(kThree.begin(), kThree.begin() + lights);
    const observe::Photograph photograph = Take(PhotographBall(GlossyScene(directions)));
    const PhotographLights found = FindPhotographLights(photograph, {});
    ExpectLights(found.scene, directions, 0.5);
    EXPECT_GT(found.least_kept, 1.3);
    EXPECT_LT(found.most_dropped, 0.7);
  }
}

TEST(PhotographLights, AreAllFoundInSeveralViews) {
  ExpectLights(FindPhotographLights(Take(PhotographBall(GlossyScene(kThree), 8)), {}).scene, kThree,
               0.2);
}

TEST(PhotographLights, AreAsManyAsAskedFor) {
  const observe::Photograph photograph = Take(PhotographBall(GlossyScene(kThree)));
  for (const int lights : {2, 3}) {
    model::ModelChoice choice;
    choice.lights = lights;
    EXPECT_EQ(FindPhotographLights(photograph, choice).scene.lights.size(),
              static_cast<std::size_t>(lights));
  }
}

TEST(PhotographLights, AreFoundWhereASpotIsMissedOrFalse) {
  observe::Photograph photograph = Take(PhotographBall(GlossyScene(kThree)));
  ASSERT_EQ(photograph.spots.size(), 3u);
  observe::Photograph missed = photograph;
  missed.spots.pop_back();
  ExpectLights(FindPhotographLights(missed, {}).scene, kThree, 0.5);
  photograph.spots.push_back({Eigen::Vector3d(0.9, -0.1, -0.3).normalized(), 0.0, 5.0, 1});
  ExpectLights(FindPhotographLights(photograph, {}).scene, kThree, 0.5);
}

TEST(PhotographLights, DoNotDependOnTheOrderOfSpots) {
  observe::Photograph photograph = Take(PhotographBall(GlossyScene(kThree)));
  const model::Scene first = FindPhotographLights(photograph, {}).scene;
  std::reverse(photograph.spots.begin(), photograph.spots.end());
  const model::Scene second = FindPhotographLights(photograph, {}).scene;
  ASSERT_EQ(first.lights.size(), second.lights.size());
  std::vector<Eigen::Vector3d> directions;
  for (const model::Light& light : first.lights) directions.push_back(light.direction);
  for (const model::Light& light : second.lights)
    EXPECT_LT(NearestDeg(light.direction, directions), 0.02);
}

}  // namespace
}  // namespace turnlight::estimator::start
