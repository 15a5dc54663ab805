// Proves: every parameter has a column of its own; the values of a moved scene are the old ones
// plus the step, wherever that is what the column says; tangents move the direction along
// themselves; bounds are kept and nothing within them is touched. Does not prove derivatives
// (normal_equations_test).
#include "estimator/model/parameters.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "estimator/model/tangent_basis.h"
#include "tests/estimator/random_observations.h"

namespace turnlight::estimator::solve {
namespace {

TEST(Columns, EachParameterHasOneOfItsOwn) {
  for (const int channels : {1, 3}) {
    const Columns columns{channels, 2};
    std::set<int> all = {columns.Ambient(), columns.Diffuse(), columns.Specular(),
                         columns.LogShininess(), columns.RoughnessSquared()};
    for (int c = 0; c < channels; ++c) all.insert(columns.Albedo(c));
    for (int l = 0; l < 2; ++l)
      for (const int column : {columns.Intensity(l), columns.Tangent(l), columns.Tangent(l) + 1,
                               columns.InverseDistance(l)})
        all.insert(column);
    EXPECT_EQ(static_cast<int>(all.size()), columns.count());
    EXPECT_EQ(*all.begin(), 0);
    EXPECT_EQ(*all.rbegin(), columns.count() - 1);
  }
}

TEST(Columns, ValuesOfAMovedSceneAreMovedByTheStep) {
  model::Scene scene = TwoLights();
  scene.reflectance.roughness = 0.4;
  const Columns columns{3, 2};
  const RandomStream random(1, 1);
  Eigen::VectorXd step(columns.count());
  for (Eigen::Index i = 0; i < step.size(); ++i)
    step[i] = 0.05 * random.Normal(static_cast<std::uint64_t>(i));
  const model::Scene moved = Moved(scene, columns, step);
  Eigen::VectorXd expected = Values(scene, columns) + step;
  for (int l = 0; l < 2; ++l) {
    const auto at = static_cast<std::size_t>(l);
    const auto basis = model::TangentBasis(scene.lights[at].direction);
    // In the plane that touches the sphere at the old direction.
    const Eigen::Vector3d u =
        moved.lights[at].direction / moved.lights[at].direction.dot(scene.lights[at].direction);
    EXPECT_LT((basis.transpose() * u - step.segment<2>(columns.Tangent(l))).norm(), 1e-14);
    EXPECT_NEAR(moved.lights[at].direction.norm(), 1.0, 1e-15);
    expected.segment<2>(columns.Tangent(l)).setZero();
  }
  EXPECT_LT((Values(moved, columns) - expected).norm(), 1e-13);
  EXPECT_NEAR(std::log(moved.reflectance.lobes[0].shape / scene.reflectance.lobes[0].shape),
              step[columns.LogShininess()], 1e-14);
}

TEST(Columns, AStepOfNothingChangesNothing) {
  model::Scene scene = TwoLights();
  scene.reflectance.roughness = 0.3;
  const Columns columns{3, 2};
  const model::Scene same = Moved(scene, columns, Eigen::VectorXd::Zero(columns.count()));
  EXPECT_EQ(same.reflectance.roughness, 0.3);
  EXPECT_EQ(same.reflectance.lobes[0].shape, scene.reflectance.lobes[0].shape);
  EXPECT_EQ(same.lights[1].intensity, scene.lights[1].intensity);
}

TEST(Columns, OneChannelIsTheAlbedoOfAll) {
  model::Scene scene = TwoLights();
  scene.reflectance.albedo.setConstant(0.5);
  const Columns columns{1, 2};
  Eigen::VectorXd step = Eigen::VectorXd::Zero(columns.count());
  step[columns.Albedo(0)] = 0.25;
  EXPECT_EQ(Moved(scene, columns, step).reflectance.albedo, Eigen::Vector3d::Constant(0.75));
}

TEST(WithinBounds, CutsWhatIsBeyondAndNothingElse) {
  const model::Scene good = TwoLights();
  const Columns columns{3, 2};
  EXPECT_EQ(Values(WithinBounds(good), columns), Values(good, columns));
  model::Scene bad = good;
  model::Reflectance& r = bad.reflectance;
  r.albedo[1] = -0.1;
  r.ambient = r.diffuse = r.lobes[0].strength = -1.0;
  r.lobes[0].shape = 1e9;
  r.roughness = 5.0;
  bad.lights[0].intensity = -0.5;
  bad.lights[0].inverse_distance = -0.1;
  bad.lights[1].inverse_distance = 2.0;
  const model::Scene cut = WithinBounds(bad);
  EXPECT_EQ(cut.reflectance.albedo, Eigen::Vector3d(0.4, 0.0, 0.7));
  EXPECT_EQ(cut.reflectance.ambient, 0.0);
  EXPECT_EQ(cut.reflectance.diffuse, 0.0);
  EXPECT_EQ(cut.reflectance.lobes[0].strength, 0.0);
  EXPECT_EQ(cut.reflectance.lobes[0].shape, model::kMaxShininess);
  EXPECT_EQ(cut.reflectance.roughness, kMaxRoughness);
  EXPECT_EQ(cut.lights[0].intensity, 0.0);
  EXPECT_EQ(cut.lights[0].inverse_distance, 0.0);
  EXPECT_EQ(cut.lights[1].inverse_distance, kMaxInverseDistance);
  r.lobes[0].shape = 0.01;
  EXPECT_EQ(WithinBounds(bad).reflectance.lobes[0].shape, model::kMinShininess);
}

}  // namespace
}  // namespace turnlight::estimator::solve
