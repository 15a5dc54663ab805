// Proves: the kernel's residuals, gradient and Gauss-Newton matrix are those of the scene model, by
// automatic differentiation of an independent formula (Ceres Jets), by finite differences where the
// footprint is sampled, and by the closed-form Shade(); the float kernel agrees with the double
// one; every instruction set and number of threads gives the same bits. Does not prove: that the
// model is right (the render checks do), nor anything at pixels within 1e-3 of a terminator, where
// the model itself has a kink. All of it for weighted pixels too.
#include "estimator/solve/normal_equations.h"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/parallel.h"
#include "estimator/model/tangent_basis.h"
#include "estimator/solve/coordinates.h"
#include "estimator/solve/footprints.h"
#include "estimator/solve/kernel/tile_kernel.h"
#include "estimator/solve/prediction.h"
#include "tests/estimator/random_observations.h"
#include "tests/estimator/solve/random_scene.h"
#include "tests/estimator/textbook_reflectance.h"

namespace turnlight::estimator::solve {
namespace {

constexpr int kMostColumns = 3 + 9 + 7 * kRandomLights + 6 + 2 * model::kHarmonics;
using Jet = ceres::Jet<double, kMostColumns>;
using JetVector = Eigen::Matrix<Jet, 3, 1>;

std::array<Jet, 2> JetHarmonics(const model::Reflectance& r, const model::Parameters& columns,
                                const Eigen::Vector3d& normal) {
  const auto variable = [](double value, int column) {
    return column < 0 ? Jet(value) : Jet(value, column);
  };
  const double x = normal.x(), y = normal.y(), z = normal.z();
  const double harmonics[] = {x, y, z, x * y, y * z, x * z, 3.0 * z * z - 1.0, x * x - y * y};
  const double squares[] = {3.0, 3.0, 3.0, 15.0, 15.0, 15.0, 1.25, 3.75};
  std::array<Jet, 2> out{variable(r.ambient, columns.Ambient()), Jet(1.0)};
  for (int j = 0; j < model::kHarmonics; ++j) {
    const double value = std::sqrt(squares[j]) * harmonics[j];
    out[0] += variable(r.harmonics[j], columns.Harmonic(j)) * value;
    out[1] += variable(r.shading[j], columns.Shading(j)) * value;
  }
  return out;
}

// The model of one pixel in Jets: columns as in Parameters, tangent coordinates at zero.
std::array<Jet, 3> JetModel(const model::Scene& scene, const RandomPoint& point) {
  const model::Parameters columns(scene, 3);
  const model::Reflectance& r = scene.reflectance;
  const auto variable = [](double value, int column) {
    return column < 0 ? Jet(value) : Jet(value, column);
  };
  const auto [ambient, departure] = JetHarmonics(r, columns, point.normal);
  const Jet diffuse = variable(r.diffuse, columns.Diffuse());
  const Jet variance = variable(r.roughness * r.roughness, columns.Roughness());
  const JetVector n = point.normal.cast<Jet>(), v = point.viewer.cast<Jet>();
  JetVector diffuse_sum = JetVector::Zero(), specular_sum = JetVector::Zero();
  for (int l = 0; l < kRandomLights; ++l) {
    const model::Light& light = scene.lights[static_cast<std::size_t>(l)];
    const Eigen::Matrix<double, 3, 2> basis = model::TangentBasis(light.direction);
    const Jet t0 = variable(0.0, columns.Tangent(l)), t1 = variable(0.0, columns.Tangent(l) + 1);
    const Jet rho = variable(light.inverse_distance, columns.InverseDistance(l));
    const Jet intensity = variable(light.intensity, columns.Intensity(l));
    JetVector u;
    for (int k = 0; k < 3; ++k)
      u[k] =
          Jet(light.direction[k]) + t0 * basis(k, 0) + t1 * basis(k, 1) - rho * point.position[k];
    const Jet squared = u.dot(u);
    const JetVector unit = u / sqrt(squared);
    if (n.dot(unit).a <= 0.0) continue;
    const Jet irradiance = intensity / squared;
    const Jet f_d = departure * textbook::Diffuse(r.diffuse_model, variance, n, unit, v);
    Jet f_s(0.0);
    for (int k = 0; k < columns.lobes(); ++k) {
      const model::Lobe& lobe = r.lobes[static_cast<std::size_t>(k)];
      const Jet shape = exp(variable(std::log(lobe.shape), columns.Shape(k)));
      f_s += variable(lobe.strength, columns.Strength(k)) *
             textbook::Lobe(lobe.model, shape, variable(lobe.f0, columns.F0(k)), n, unit, v);
    }
    for (int c = 0; c < 3; ++c) {
      const Jet colour = variable(light.color[c], columns.Colour(l, c));
      diffuse_sum[c] += irradiance * colour * f_d;
      specular_sum[c] += irradiance * colour * f_s;
    }
  }
  std::array<Jet, 3> model;
  for (int c = 0; c < 3; ++c)
    model[static_cast<std::size_t>(c)] =
        variable(r.albedo[c], columns.Albedo(c)) *
            (ambient * variable(r.ambient_colour[c], columns.AmbientColour(c)) +
             diffuse * diffuse_sum[c]) +
        specular_sum[c] * variable(r.specular_colour[c], columns.SpecularColour(c));
  return model;
}

// Pixels where the model has a kink within 1e-3 are left out.
bool AtKink(const model::Scene& scene, const RandomPoint& point) {
  for (const model::Light& light : scene.lights) {
    const Eigen::Vector3d l =
        (light.direction - light.inverse_distance * point.position).normalized();
    const double nl = point.normal.dot(l);
    const double rv = (2.0 * nl * point.normal - l).dot(point.viewer);
    if (std::abs(nl) < 1e-3 || std::abs(rv) < 1e-3) return true;
    // Oren-Nayar's own kinks.
    const double nv = point.normal.dot(point.viewer);
    if (std::abs(l.dot(point.viewer) - nl * nv) < 1e-3 || std::abs(nl - nv) < 1e-3) return true;
  }
  return false;
}

void Remove(RandomObservations& all, std::size_t i) {
  all.observations.pixel[i] = observe::Observations::kNoPixel;
}

struct Reference {
  Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(kMostColumns, kMostColumns);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(kMostColumns);
  double cost = 0.0;
};

Reference ByJets(RandomObservations& all, const model::Scene& scene) {
  Reference out;
  for (std::size_t i = 0; i < all.points.size(); ++i) {
    if (AtKink(scene, all.points[i])) {
      Remove(all, i);
      continue;
    }
    const auto model = JetModel(scene, all.points[i]);
    const double weight = std::pow(all.observations.WeightOf(i), 2);
    for (int c = 0; c < 3; ++c) {
      const Jet& value = model[static_cast<std::size_t>(c)];
      const double residual = value.a - static_cast<double>(all.observations.radiance[c][i]);
      out.cost += 0.5 * weight * residual * residual;
      out.gradient += weight * residual * value.v;
      out.hessian += weight * value.v * value.v.transpose();
    }
  }
  return out;
}

// Differences relative to the columns' own sizes.
void ExpectSame(const NormalEquations& equations, const Reference& reference, double tolerance) {
  EXPECT_NEAR(equations.cost, reference.cost, tolerance * reference.cost);
  const double residual = std::sqrt(2.0 * reference.cost);
  const auto columns = static_cast<int>(equations.gradient.size());
  for (int i = 0; i < columns; ++i) {
    const double size_i = std::sqrt(reference.hessian(i, i)) + 1e-12;
    EXPECT_NEAR(equations.gradient[i], reference.gradient[i], tolerance * size_i * residual) << i;
    for (int j = 0; j < columns; ++j) {
      const double size_j = std::sqrt(reference.hessian(j, j)) + 1e-12;
      EXPECT_NEAR(equations.hessian(i, j), reference.hessian(i, j), tolerance * size_i * size_j)
          << i << " " << j;
    }
  }
}

// Geometry rounded to float is unit only to 1e-7; cosines (the jets) and chords (the kernel) of it
// part by that times the shininess. Below a shininess of 1 the slope of the lobe grows without
// bound towards its edge, and the rounding with it.
double Rounding(const model::Scene& scene) {
  const double n = model::LobeInverseVariance(scene.reflectance.lobes[0]);
  return n < 1.0 ? 1e-4 : 3e-7 * n;
}

struct Models {
  model::SpecularModel specular;
  model::DiffuseModel diffuse;
};
class DerivativesTest : public testing::TestWithParam<Models> {};

TEST_P(DerivativesTest, AgreeWithAutodiffAtRandomStates) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    const model::Scene scene = RandomScene(seed, GetParam().specular, GetParam().diffuse);
    RandomObservations all(300, 3, seed);
    if (seed % 2 == 0) GiveWeights(seed, all.observations);
    const Reference reference = ByJets(all, scene);
    const double rounding = Rounding(scene);
    ExpectSame(EvaluateDouble(all.observations, scene, {}), reference, 1e-6 + rounding);
    ExpectSame(Evaluate(all.observations, scene, {}), reference, 1e-5 + rounding);
  }
}

TEST_P(DerivativesTest, AgreeWithAutodiffNearTheEdges) {
  const bool physical = model::FactsOf(GetParam().specular).physical;
  for (const double shape : physical ? std::vector{0.02, 0.2, 1.0} : std::vector{0.5, 1.0, 1e4}) {
    for (const double rho : {0.0, 0.9}) {
      model::Scene scene = RandomScene(99, GetParam().specular, GetParam().diffuse);
      scene.reflectance.lobes[0].shape = shape;
      scene.lights[0].inverse_distance = rho;
      scene.lights[0].direction = Eigen::Vector3d(1.0, 0.2, 1e-3).normalized();  // at the horizon
      RandomObservations all(600, 3, 5);
      const Reference reference = ByJets(all, scene);
      SCOPED_TRACE(testing::Message() << "shape " << shape << " rho " << rho);
      const double rounding = Rounding(scene);
      ExpectSame(EvaluateDouble(all.observations, scene, {}), reference, 1e-6 + rounding);
      ExpectSame(Evaluate(all.observations, scene, {}), reference, 1e-5 + rounding);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Models, DerivativesTest,
    testing::Values(Models{model::SpecularModel::kPhong, model::DiffuseModel::kLambert},
                    Models{model::SpecularModel::kBlinnPhong, model::DiffuseModel::kLambert},
                    Models{model::SpecularModel::kNone, model::DiffuseModel::kLambert},
                    Models{model::SpecularModel::kBeckmann, model::DiffuseModel::kLambert},
                    Models{model::SpecularModel::kGgx, model::DiffuseModel::kCoated},
                    Models{model::SpecularModel::kPhong, model::DiffuseModel::kOrenNayar}));

// Every second one with weights.
void ExpectAutodiff(const model::Scene& scene, std::uint64_t seed) {
  RandomObservations all(300, 3, seed);
  if (seed % 2 == 0) GiveWeights(seed, all.observations);
  const Reference reference = ByJets(all, scene);
  ExpectSame(EvaluateDouble(all.observations, scene, {}), reference, 1e-5);
  ExpectSame(Evaluate(all.observations, scene, {}), reference, 3e-5);
}

// Two lobes, lights of their own colours, and a light field.
TEST(Derivatives, OfTwoLobesColoursAndHarmonicsAgreeWithAutodiff) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(seed);
    model::Scene scene =
        RandomScene(seed, model::SpecularModel::kGgx, model::DiffuseModel::kLambert);
    scene.reflectance.lobes[1] = {model::SpecularModel::kPhong, 0.2, 9.0};
    scene.free_colours = true;
    scene.reflectance.ambient_colour = {0.7, 1.0, 0.4};
    scene.reflectance.specular_colour = {1.0, 0.8, 0.9};
    scene.free_harmonics = true;
    for (int j = 0; j < model::kHarmonics; ++j) scene.reflectance.harmonics[j] = 0.02 * (j - 3);
    scene.lights[0].color = {1.0, 0.6, 0.3};
    scene.lights[1].color = {0.5, 0.9, 1.0};
    ExpectAutodiff(scene, seed);
  }
}

// A diffuse part that departs from its model, of each model.
TEST(Derivatives, OfDeparturesAgreeWithAutodiff) {
  for (std::uint64_t seed = 1; seed <= 9; ++seed) {
    SCOPED_TRACE(seed);
    model::Scene scene =
        RandomScene(seed, model::SpecularModel::kGgx, static_cast<model::DiffuseModel>(seed % 3));
    scene.free_shading = true;
    scene.free_harmonics = seed > 5;
    for (int j = 0; j < model::kHarmonics; ++j) scene.reflectance.shading[j] = 0.03 * (4 - j);
    ExpectAutodiff(scene, seed);
  }
}

// What departures cost is a square in the cost, with its gradient and matrix.
TEST(Prices, OfDeparturesAreASquare) {
  model::Scene scene = RandomScene(2, model::SpecularModel::kPhong, model::DiffuseModel::kCoated);
  scene.free_shading = true;
  for (int j = 0; j < model::kHarmonics; ++j) scene.reflectance.shading[j] = 0.05 * (j - 2);
  RandomObservations all(300, 3, 2);
  EvaluateOptions priced;
  priced.shading_price = 7.0;
  const NormalEquations without = EvaluateDouble(all.observations, scene, {}),
                        with = EvaluateDouble(all.observations, scene, priced);
  EXPECT_NEAR(with.cost - without.cost, 3.5 * scene.reflectance.shading.squaredNorm(), 1e-9);
  const model::Parameters columns(scene, 3);
  for (int j = 0; j < model::kHarmonics; ++j) {
    const int column = columns.Shading(j);
    EXPECT_NEAR(with.gradient[column] - without.gradient[column],
                7.0 * scene.reflectance.shading[j], 1e-9);
    EXPECT_NEAR(with.hessian(column, column) - without.hessian(column, column), 7.0, 1e-9);
  }
}

// Far points from every kink, so that a finite step crosses none.
void KeepSmooth(RandomObservations& all, const model::Scene& scene) {
  for (std::size_t i = 0; i < all.points.size(); ++i)
    if (AtKink(scene, all.points[i])) Remove(all, i);
}

TEST(FootprintTest, GradientIsTheSlopeOfTheCost) {
  for (const model::SpecularModel specular :
       {model::SpecularModel::kPhong, model::SpecularModel::kBlinnPhong,
        model::SpecularModel::kBeckmann, model::SpecularModel::kGgx}) {
    for (const double huber : {0.0, 0.05}) {
      const model::Scene scene = RandomScene(3, specular, model::DiffuseModel::kOrenNayar);
      RandomObservations all(300, 3, 11);
      KeepSmooth(all, scene);
      if (huber > 0.0) GiveWeights(6, all.observations);
      const RandomStream random(4, 4);
      for (auto& component : all.observations.footprint)
        for (std::size_t i = 0; i < component.size(); ++i)
          component[i] = observe::ToBFloat16(static_cast<float>(0.03 * random.Normal(i)));
      for (std::size_t k = 0; k < 6; ++k)
        for (std::size_t i = 0; i < all.observations.step[k].size(); ++i)
          all.observations.step[k][i] =
              observe::ToBFloat16(static_cast<float>(0.03 * random.Normal(100000 * (k + 1) + i)));
      EvaluateOptions options;
      options.samples_per_side.assign(all.observations.tiles(), 3);
      options.huber = huber;
      const NormalEquations at = EvaluateDouble(all.observations, scene, options);
      const model::Parameters columns(scene, 3);
      const auto moved = [&](int column, double step) {
        return model::Moved(scene, columns, step * Eigen::VectorXd::Unit(columns.count(), column));
      };
      for (int column = 0; column < columns.count(); ++column) {
        constexpr double kStep = 1e-6;
        const double up = EvaluateDouble(all.observations, moved(column, kStep), options).cost;
        const double down = EvaluateDouble(all.observations, moved(column, -kStep), options).cost;
        const double size = std::sqrt(at.hessian(column, column) * 2.0 * at.cost);
        EXPECT_NEAR(at.gradient[column], (up - down) / (2.0 * kStep), 2e-5 * size + 1e-8) << column;
      }
    }
  }
}

TEST(FootprintTest, MeanOverTheFootprintOfAWideLobeIsItsCentre) {
  const model::Scene scene =
      RandomScene(8, model::SpecularModel::kPhong, model::DiffuseModel::kLambert);
  RandomObservations all(256, 3, 2);
  EvaluateOptions fine;
  fine.samples_per_side.assign(all.observations.tiles(), 5);
  // No footprint stored: every sub-sample is the centre, and the weights sum to one.
  const double a = EvaluateDouble(all.observations, scene, {}).cost;
  const double b = EvaluateDouble(all.observations, scene, fine).cost;
  EXPECT_NEAR(a, b, 1e-6 * a);
}

TEST(RepeatabilityTest, SameBitsForAnyNumberOfThreads) {
  const model::Scene scene =
      RandomScene(2, model::SpecularModel::kPhong, model::DiffuseModel::kLambert);
  const RandomObservations all(100000, 3, 1);
  SetThreads(1);
  const NormalEquations one = Evaluate(all.observations, scene, {});
  for (const int threads : {2, 7}) {
    SetThreads(threads);
    const NormalEquations many = Evaluate(all.observations, scene, {});
    EXPECT_EQ(one.cost, many.cost);
    EXPECT_TRUE(one.gradient == many.gradient);
    EXPECT_TRUE(one.hessian == many.hessian);
  }
  SetThreads(0);
}

TEST(RepeatabilityTest, WeightsOfOneChangeNoBit) {
  const model::Scene scene =
      RandomScene(2, model::SpecularModel::kPhong, model::DiffuseModel::kLambert);
  RandomObservations all(10000, 3, 1);
  for (const double huber : {0.0, 0.05}) {
    EvaluateOptions options;
    options.huber = huber;
    all.observations.weight.clear();
    const NormalEquations without = Evaluate(all.observations, scene, options);
    all.observations.weight.assign(all.observations.size(), 1.0f);
    const NormalEquations with = Evaluate(all.observations, scene, options);
    EXPECT_EQ(without.cost, with.cost);
    EXPECT_TRUE(without.gradient == with.gradient);
    EXPECT_TRUE(without.hessian == with.hessian);
  }
}

TEST(RepeatabilityTest, SameBitsWithoutTheMatrix) {
  const model::Scene scene =
      RandomScene(2, model::SpecularModel::kPhong, model::DiffuseModel::kLambert);
  const RandomObservations all(100000, 3, 1);
  EvaluateOptions options;
  const NormalEquations full = Evaluate(all.observations, scene, options);
  options.gradient_only = true;
  const NormalEquations part = Evaluate(all.observations, scene, options);
  EXPECT_EQ(full.cost, part.cost);
  EXPECT_TRUE(full.gradient == part.gradient);
}

TEST(RepeatabilityTest, EveryInstructionSetGivesTheSameBits) {
  const kernel::KernelFunctions* all[3];
  const int count = kernel::RunnableKernels(all, 3);
  RandomObservations random(observe::kTile * 4, 3, 9);
  GiveWeights(2, random.observations);
  const observe::Observations& o = random.observations;
  const kernel::KernelLight light{{0, 0, 1}, {{1, 0, 0}, {0, 1, 0}}, 0.3, 0.8};
  kernel::KernelModel model{};
  model.channels = 3;
  model.lights = 1;
  model.light = &light;
  model.ambient = 0.1, model.diffuse = 0.6;
  model.lobes = 2;
  model.lobe[0] = {0, 0.4, 37.0, 1.0, 2, 3, -1};
  model.lobe[1] = {3, 0.1, 0.2, 0.5, 6, 7, 5};
  model.ambient_row = 0, model.diffuse_row = 1, model.roughness_row = 4, model.first_light_row = 8;
  for (double& albedo : model.albedo) albedo = 0.7;
  model.l11 = 1.2, model.l21 = 1.7, model.l22 = 0.3;
  kernel::KernelPixels pixels{};
  for (int k = 0; k < 3; ++k) {
    pixels.position[k] = o.position[k].data();
    pixels.normal[k] = o.normal[k].data();
    pixels.mirrored[k] = o.mirrored[k].data();
    pixels.radiance[k] = o.radiance[k].data();
  }
  for (int k = 0; k < 6; ++k) {
    pixels.footprint[k] = o.footprint[k].data();
    pixels.step[k] = o.step[k].data();
  }
  pixels.pixel = o.pixel.data();
  model.weighted = true;
  pixels.weight = o.weight.data();
  pixels.tiles = o.tiles();
  const int n = model.Shared();
  std::vector<std::vector<double>> results;
  for (int i = 0; i < count; ++i) {
    std::vector<float> workspace(kernel::WorkspaceSize(n));
    auto& values = results.emplace_back(static_cast<std::size_t>(n * n + 3 * n), 0.0);
    kernel::KernelSums sums{};
    sums.shared = values.data();
    sums.gradient = sums.shared + n * n;
    sums.albedo_a = sums.gradient + n;
    sums.albedo_b = sums.albedo_a + n;
    all[i]->accumulate(model, pixels, workspace.data(), sums);
    values.push_back(sums.cost);
    EXPECT_EQ(results.front(), values) << all[i]->name;
  }
}

}  // namespace
}  // namespace turnlight::estimator::solve
