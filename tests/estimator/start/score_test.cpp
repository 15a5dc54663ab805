// Proves: the score prefers what explains more where it pays its price, to the price; it is an
// order, whichever way candidates are listed; lights pay together what each pays alone; a number of
// lights that is asked for comes first. Does not prove that the prices are right: bench/studies
// does.
#include "estimator/start/score.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <random>
#include <vector>

namespace turnlight::estimator::start {
namespace {

model::Scene SceneOf(std::size_t lights, bool rough = false) {
  model::Scene scene;
  scene.lights.resize(lights);
  if (rough) scene.reflectance.diffuse_model = model::DiffuseModel::kOrenNayar;
  return scene;
}

std::size_t Better(const model::Scene& a, double excess_a, const model::Scene& b, double excess_b) {
  return BestOf({}, {{&a, excess_a}, {&b, excess_b}});
}

TEST(Score, ALightMustMakeTheExcessThreeTimesSmaller) {
  const model::Scene one = SceneOf(1), two = SceneOf(2);
  EXPECT_EQ(Better(one, 2.99, two, 1.0), 0u);
  EXPECT_EQ(Better(one, 3.01, two, 1.0), 1u);
  // In any unit.
  EXPECT_EQ(Better(one, 2.99e-9, two, 1e-9), 0u);
  EXPECT_EQ(Better(one, 3.01e-9, two, 1e-9), 1u);
}

TEST(Score, ARoughSurfaceIsCheaperThanALight) {
  const model::Scene smooth = SceneOf(2), rough = SceneOf(2, true), more = SceneOf(3);
  EXPECT_EQ(Better(smooth, 1.24, rough, 1.0), 0u);
  EXPECT_EQ(Better(smooth, 1.26, rough, 1.0), 1u);
  EXPECT_EQ(Better(rough, 1.0, more, 1.0), 0u);
}

TEST(Score, PartsOfAModelCostWhatIsSaid) {
  model::Scene scene = SceneOf(2);
  EXPECT_EQ(PriceOf(scene), 2.0 * kLightPrice);
  model::SetLobeModel(scene.reflectance, model::SpecularModel::kGgx);
  EXPECT_EQ(PriceOf(scene), 2.0 * kLightPrice + kLobePrice);
  scene.reflectance.lobes[1] = scene.reflectance.lobes[0];
  EXPECT_EQ(PriceOf(scene), 2.0 * kLightPrice + kLobePrice + kSecondLobePrice);
  scene.reflectance.diffuse_model = model::DiffuseModel::kCoated;
  scene.free_colours = true;
  EXPECT_EQ(PriceOf(scene),
            2.0 * kLightPrice + kLobePrice + kSecondLobePrice + kCoatPrice + kColourPrice);
}

// Each of six lights explains 2.5 of what is left with all of them: needed alone, and together.
TEST(Score, LightsPayTogetherWhatEachPaysAlone) {
  const model::Scene all = SceneOf(8);
  for (std::size_t fewer = 1; fewer <= 6; ++fewer) {
    const model::Scene without = SceneOf(8 - fewer);
    const double left = static_cast<double>(fewer);
    EXPECT_EQ(Better(without, 1.0 + 2.5 * left, all, 1.0), 1u);
    EXPECT_EQ(Better(without, 1.0 + 1.5 * left, all, 1.0), 0u);
  }
}

// With thresholds on ratios B of these beat A, C beat B and A beat C.
TEST(Score, IsAnOrder) {
  const model::Scene a = SceneOf(1), b = SceneOf(5), c = SceneOf(3, true);
  std::vector<Compared> compared{{&a, 100.0}, {&b, 30.0}, {&c, 20.0}};
  const auto by_scene = [](const Compared& x, const Compared& y) { return x.scene < y.scene; };
  std::sort(compared.begin(), compared.end(), by_scene);
  do EXPECT_EQ(compared[BestOf({}, compared)].scene, &a);
  while (std::next_permutation(compared.begin(), compared.end(), by_scene));
}

TEST(Score, TheBestIsTheSameInAnyOrder) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> logarithm(-3.0, 3.0);
  for (int draw = 0; draw < 100; ++draw) {
    std::vector<model::Scene> scenes;
    for (int k = 0; k < 6; ++k) scenes.push_back(SceneOf(random() % 6, random() % 2 == 0));
    std::vector<Compared> compared;
    for (const model::Scene& scene : scenes)
      compared.push_back({&scene, std::exp(logarithm(random))});
    const model::Scene* best = compared[BestOf({}, compared)].scene;
    for (int k = 0; k < 10; ++k) {
      std::shuffle(compared.begin(), compared.end(), random);
      EXPECT_EQ(compared[BestOf({}, compared)].scene, best);
    }
  }
}

TEST(Score, ANumberThatIsAskedForComesFirst) {
  const model::Scene two = SceneOf(2), three = SceneOf(3), six = SceneOf(6);
  model::ModelChoice choice;
  choice.lights = 4;
  EXPECT_EQ(BestOf(choice, {{&two, 1.0}, {&three, 50.0}, {&six, 1.0}}), 1u);
  choice.lights = 6;
  EXPECT_EQ(BestOf(choice, {{&two, 1.0}, {&three, 50.0}, {&six, 1.0}}), 2u);
}

}  // namespace
}  // namespace turnlight::estimator::start
