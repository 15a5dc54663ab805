// Proves: every parameter has a column of its own, by the models that the scene has; the values of
// a moved scene are the old ones plus the step, wherever that is what the column says; tangents
// move the direction along themselves; bounds are kept and nothing within them is touched. Does not
// prove derivatives (normal_equations_test).
#include "estimator/model/parameters.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "estimator/model/tangent_basis.h"
#include "tests/estimator/random_observations.h"

namespace turnlight::estimator::model {
namespace {

TEST(Parameters, EachParameterHasOneOfItsOwn) {
  for (const int channels : {1, 3}) {
    const Parameters parameters = PlainParameters(channels, 2);
    std::set<int> all = {parameters.Ambient(), parameters.Diffuse(), parameters.Strength(0),
                         parameters.Shape(0), parameters.Roughness()};
    for (int c = 0; c < channels; ++c) all.insert(parameters.Albedo(c));
    for (int l = 0; l < 2; ++l)
      for (const int column : {parameters.Intensity(l), parameters.Tangent(l),
                               parameters.Tangent(l) + 1, parameters.InverseDistance(l)})
        all.insert(column);
    EXPECT_EQ(static_cast<int>(all.size()), parameters.count());
    EXPECT_EQ(*all.begin(), 0);
    EXPECT_EQ(*all.rbegin(), parameters.count() - 1);
  }
}

TEST(Parameters, ValuesOfAMovedSceneAreMovedByTheStep) {
  Scene scene = TwoLights();
  scene.reflectance.roughness = 0.4;
  const Parameters parameters = PlainParameters(3, 2);
  const RandomStream random(1, 1);
  Eigen::VectorXd step(parameters.count());
  for (Eigen::Index i = 0; i < step.size(); ++i)
    step[i] = 0.05 * random.Normal(static_cast<std::uint64_t>(i));
  const Scene moved = Moved(scene, parameters, step);
  Eigen::VectorXd expected = Values(scene, parameters) + step;
  for (int l = 0; l < 2; ++l) {
    const auto at = static_cast<std::size_t>(l);
    const auto basis = TangentBasis(scene.lights[at].direction);
    // In the plane that touches the sphere at the old direction.
    const Eigen::Vector3d u =
        moved.lights[at].direction / moved.lights[at].direction.dot(scene.lights[at].direction);
    EXPECT_LT((basis.transpose() * u - step.segment<2>(parameters.Tangent(l))).norm(), 1e-14);
    EXPECT_NEAR(moved.lights[at].direction.norm(), 1.0, 1e-15);
    expected.segment<2>(parameters.Tangent(l)).setZero();
  }
  EXPECT_LT((Values(moved, parameters) - expected).norm(), 1e-13);
  EXPECT_NEAR(std::log(moved.reflectance.lobes[0].shape / scene.reflectance.lobes[0].shape),
              step[parameters.Shape(0)], 1e-14);
}

TEST(Parameters, AStepOfNothingChangesNothing) {
  Scene scene = TwoLights();
  scene.reflectance.roughness = 0.3;
  const Parameters parameters = PlainParameters(3, 2);
  const Scene same = Moved(scene, parameters, Eigen::VectorXd::Zero(parameters.count()));
  EXPECT_EQ(same.reflectance.roughness, 0.3);
  EXPECT_EQ(same.reflectance.lobes[0].shape, scene.reflectance.lobes[0].shape);
  EXPECT_EQ(same.lights[1].intensity, scene.lights[1].intensity);
}

TEST(Parameters, OneChannelIsTheAlbedoOfAll) {
  Scene scene = TwoLights();
  scene.reflectance.albedo.setConstant(0.5);
  const Parameters parameters = PlainParameters(1, 2);
  Eigen::VectorXd step = Eigen::VectorXd::Zero(parameters.count());
  step[parameters.Albedo(0)] = 0.25;
  EXPECT_EQ(Moved(scene, parameters, step).reflectance.albedo, Eigen::Vector3d::Constant(0.75));
}

TEST(Parameters, AreThoseOfTheModels) {
  Scene scene = TwoLights();
  EXPECT_EQ(Parameters(scene, 3).F0(0), -1);
  EXPECT_EQ(Parameters(scene, 3).Strength(1), -1);
  scene.reflectance.lobes = {Lobe{SpecularModel::kGgx, 0.2, 0.3, 0.5},
                             Lobe{SpecularModel::kPhong, 0.1, 12.0}};
  scene.free_colours = true;
  const Parameters all(scene, 3);
  EXPECT_EQ(all.count(), 3 + 5 + 1 + 2 + 4 * 2 + 3 * 2 + 3 + 3);
  std::set<int> found;
  for (int lobe = 0; lobe < 2; ++lobe)
    for (const int column : {all.Strength(lobe), all.Shape(lobe)}) found.insert(column);
  found.insert(all.F0(0));
  for (int light = 0; light < 2; ++light)
    for (int channel = 0; channel < 3; ++channel) found.insert(all.Colour(light, channel));
  EXPECT_EQ(found.size(), 11u);
  EXPECT_EQ(found.count(-1), 0u);
  EXPECT_EQ(all.F0(1), -1);
  EXPECT_EQ(NameOf(all[all.Shape(0)], scene), "alpha");
  EXPECT_EQ(NameOf(all[all.Shape(1)], scene), "shininess of lobe 2");
  EXPECT_EQ(NameOf(all[all.Colour(1, 2)], scene), "colour of light 2");
  // An alpha ends where its model does, in the logarithm.
  EXPECT_EQ(LimitsOf(all[all.Shape(0)], scene).high,
            std::log(FactsOf(SpecularModel::kGgx).most_shape));
  EXPECT_EQ(LimitsOf(all[all.F0(0)], scene).low, kLeastF0);
  EXPECT_EQ(LimitsOf(all[all.F0(0)], scene).high, 1.0);
}

TEST(WithinBounds, CutsWhatIsBeyondAndNothingElse) {
  const Scene good = TwoLights();
  const Parameters parameters = PlainParameters(3, 2);
  EXPECT_EQ(Values(WithinBounds(good), parameters), Values(good, parameters));
  Scene bad = good;
  Reflectance& r = bad.reflectance;
  r.albedo[1] = -0.1;
  r.ambient = r.diffuse = r.lobes[0].strength = -1.0;
  r.lobes[0].shape = 1e9;
  r.roughness = 5.0;
  bad.lights[0].intensity = -0.5;
  bad.lights[0].inverse_distance = -0.1;
  bad.lights[1].inverse_distance = 2.0;
  const Scene cut = WithinBounds(bad);
  EXPECT_EQ(cut.reflectance.albedo, Eigen::Vector3d(0.4, 0.0, 0.7));
  EXPECT_EQ(cut.reflectance.ambient, 0.0);
  EXPECT_EQ(cut.reflectance.diffuse, 0.0);
  EXPECT_EQ(cut.reflectance.lobes[0].strength, 0.0);
  EXPECT_EQ(cut.reflectance.lobes[0].shape, FactsOf(SpecularModel::kPhong).most_shape);
  EXPECT_EQ(cut.reflectance.roughness, kMaxRoughness);
  EXPECT_EQ(cut.lights[0].intensity, 0.0);
  EXPECT_EQ(cut.lights[0].inverse_distance, 0.0);
  EXPECT_EQ(cut.lights[1].inverse_distance, kMaxInverseDistance);
  r.lobes[0].shape = 0.01;
  EXPECT_EQ(WithinBounds(bad).reflectance.lobes[0].shape,
            FactsOf(SpecularModel::kPhong).least_shape);
}

}  // namespace
}  // namespace turnlight::estimator::model
