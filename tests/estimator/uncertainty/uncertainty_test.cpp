// Proves: where the problem is a mean, in closed form: sigma_stat is that of a mean of independent
// values, of clusters that go together, of views that repeat; the model's part is what halves
// disagree by; what the data do not determine has no sigma. And on a whole scene, over draws of the
// noise, that sigma_stat is that of the errors. Does not prove coverage where the model is wrong:
// unknown_errors_test and bench/studies do.
#include "estimator/uncertainty/uncertainty.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/estimator/random_observations.h"

namespace turnlight::estimator::uncertainty {
namespace {

constexpr std::size_t kMeanTiles = 64, kMeanPixels = kMeanTiles * observe::kTile;

// Grey pictures of ambient light alone: the fit is the mean of all values.
struct MeanProblem {
  observe::Observations pixels;
  solve::Solution solution;
  ResidualSplits splits;

  MeanProblem(double noise, std::size_t views, const std::function<double(std::size_t)>& offset) {
    model::Scene scene;
    scene.reflectance.ambient = 0.5;
    scene.reflectance.lobes[0].model = model::SpecularModel::kNone;
    pixels = RandomObservations(kMeanPixels, 1, 1, &scene).observations;
    AddNoise(noise, 1, pixels);
    for (std::size_t i = 0; i < kMeanPixels; ++i) {
      pixels.radiance[0][i] += static_cast<float>(offset(i));
      pixels.pixel[i] *= 5;  // apart, for what neighbours have in common would be texture
    }
    pixels.tile_begin.clear();
    for (std::size_t k = 0; k <= views; ++k) pixels.tile_begin.push_back(k * kMeanTiles / views);
    solution = solve::Solve(pixels, scene, {});
    splits = SplitResiduals(pixels, solution);
  }
  Uncertainties Sigmas(double views_per_distinct = 1.0) const {
    return EstimateUncertainty(solution, pixels, {}, views_per_distinct, splits);
  }
};

TEST(EstimateUncertainty, OfAMeanOfIndependentValues) {
  const MeanProblem mean(0.02, 2, [](std::size_t) { return 0.0; });
  const double expected = 0.02 / std::sqrt(static_cast<double>(kMeanPixels));
  EXPECT_NEAR(mean.Sigmas().stat.ambient, expected, 0.03 * expected);
  EXPECT_LT(mean.Sigmas().total.ambient, 1.2 * expected);
  EXPECT_NEAR(mean.Sigmas(4.0).stat.ambient, 2.0 * expected, 0.06 * expected)
      << "of four views three repeat";
  EXPECT_TRUE(std::isnan(mean.Sigmas().stat.diffuse)) << "no light: nothing is known of k_d";
}

// Each tile has an offset of its own: as many independent values as tiles.
TEST(EstimateUncertainty, OfClustersThatGoTogether) {
  const RandomStream random(8, 8);
  constexpr double kOffset = 0.05;
  const MeanProblem mean(
      0.001, 1, [&](std::size_t i) { return kOffset * random.Normal(i / observe::kTile); });
  const double expected = kOffset / std::sqrt(static_cast<double>(kMeanTiles));
  EXPECT_NEAR(mean.Sigmas().stat.ambient, expected, 0.3 * expected);
}

// One view is brighter by d than the other. Half of that is what each half is off the whole; it
// counts twice, less what may be chance.
TEST(EstimateUncertainty, OfHalvesThatDisagree) {
  constexpr double kDifference = 0.05;
  const MeanProblem mean(0.001, 2,
                         [](std::size_t i) { return i < kMeanPixels / 2 ? 0.0 : kDifference; });
  const Uncertainties sigmas = mean.Sigmas();
  const double model = std::sqrt(sigmas.total.ambient * sigmas.total.ambient -
                                 sigmas.stat.ambient * sigmas.stat.ambient);
  EXPECT_GT(model, 0.85 * kDifference);
  EXPECT_LT(model, 1.05 * kDifference);
}

// The same as items: squares add up, and what disagrees has its own.
TEST(EstimateUncertainty, BudgetOfHalvesThatDisagree) {
  const MeanProblem mean(0.001, 2, [](std::size_t i) { return i < kMeanPixels / 2 ? 0.0 : 0.05; });
  const Uncertainties sigmas = mean.Sigmas();
  ASSERT_GE(sigmas.budget.size(), 2u);
  EXPECT_EQ(sigmas.budget[0].words.item, "noise");
  EXPECT_EQ(sigmas.budget[0].sigma.ambient, sigmas.stat.ambient);
  double squares = 0.0, halves = 0.0;
  for (const BudgetItem& item : sigmas.budget) {
    squares += item.sigma.ambient * item.sigma.ambient;
    if (item.words.item == "halves") halves = item.sigma.ambient;
  }
  EXPECT_NEAR(squares, sigmas.total.ambient * sigmas.total.ambient, 1e-12 * squares);
  EXPECT_GT(halves, 0.04);
}

// One view of two lights that are told as one, 0.2 rad from where each is, with more than noise
// left: the one is as far from either. Where there is one light, it is where it is.
TEST(EstimateUncertainty, ALightThatMayBeTwo) {
  constexpr double kApart = 0.2;
  const auto sigma_of = [](double apart) {
    model::Scene one;
    one.reflectance.lobes[0].model = model::SpecularModel::kNone;
    one.lights = {TwoLights().lights[0]};
    one.lights[0].inverse_distance = 0.0;
    model::Scene two = one;
    two.lights.push_back(one.lights[0]);
    const Eigen::Vector3d axis = one.lights[0].direction.unitOrthogonal();
    for (const std::size_t l : {0u, 1u}) {
      two.lights[l].intensity *= 0.5;
      two.lights[l].direction =
          (one.lights[0].direction + (l == 0 ? apart : -apart) * axis).normalized();
    }
    observe::Observations all = RandomObservations(16000, 1, 1, &two).observations;
    AddNoise(0.005, 1, all);
    solve::SolveOptions options;
    options.evaluate.huber = 0.02;
    options.fixed_distance = {true};
    const solve::Solution solution = solve::Solve(all, one, options);
    return EstimateUncertainty(solution, all, {0}, 1.0, SplitResiduals(all, solution))
        .total.lights[0]
        .direction;
  };
  EXPECT_GT(sigma_of(kApart), 0.5 * kApart);
  EXPECT_LT(sigma_of(kApart), 1.7 * kApart);
  EXPECT_LT(sigma_of(0.0), 0.01 * kApart);
}

// A calibration that would move the gradient as a change of all values by 0.01 does: so much it
// adds.
TEST(EstimateUncertainty, CalibrationIsAnItemOfTheTotal) {
  const MeanProblem mean(0.001, 2, [](std::size_t) { return 0.0; });
  CalibrationResponse calibration;
  calibration.as_modelled = mean.solution.equations;
  const Eigen::Index ambient = PlainParameters(1, 0).Ambient();
  Eigen::MatrixXd gradient = Eigen::MatrixXd::Zero(calibration.as_modelled.gradient.size(), 1);
  gradient(ambient, 0) = 0.01 * calibration.as_modelled.hessian(ambient, ambient);
  calibration.items.push_back({{"axis", "axis of the table", "calibrate"}, gradient});
  const Uncertainties without = mean.Sigmas();
  const Uncertainties with =
      EstimateUncertainty(mean.solution, mean.pixels, {}, 1.0, mean.splits, &calibration);
  EXPECT_EQ(with.budget.back().words.item, "axis");
  EXPECT_NEAR(with.budget.back().sigma.ambient, 0.01, 1e-6);
  EXPECT_NEAR(with.calibration.ambient, 0.01, 1e-6);
  EXPECT_NEAR(with.total.ambient, std::hypot(without.total.ambient, 0.01), 1e-6);
  EXPECT_EQ(with.stat.ambient, without.stat.ambient);
}

TEST(EstimateUncertainty, StatisticalSigmasAreThoseOfTheErrors) {
  const model::Scene truth = TwoLights();
  constexpr int kDraws = 60;
  double direction = 0.0, distance = 0.0, ambient = 0.0, shininess = 0.0;
  const RandomObservations clean(2000, 3, 1, &truth);
  for (int draw = 0; draw < kDraws; ++draw) {
    observe::Observations pixels = clean.observations;
    AddNoise(0.01, static_cast<std::uint64_t>(draw), pixels);
    const solve::Solution solution = solve::Solve(pixels, truth, {});
    const Uncertainty stat =
        EstimateUncertainty(solution, pixels, {0, 1}, 1.0, SplitResiduals(pixels, solution)).stat;
    const Reported found = Report(solution.scene, pixels, {0, 1});
    const Reported right = Report(truth, pixels, {0, 1});
    const auto square = [](double error, double sigma) {
      return error * error / (sigma * sigma) / kDraws;
    };
    const auto& light = found.lights[1].light;
    const auto& true_light = right.lights[1].light;
    direction += square((light.direction - true_light.direction).norm(), stat.lights[1].direction);
    distance += square(light.inverse_distance - true_light.inverse_distance,
                       stat.lights[1].inverse_distance);
    ambient += square(found.reflectance.ambient - right.reflectance.ambient, stat.ambient);
    shininess += square(found.reflectance.lobes[0].shape - right.reflectance.lobes[0].shape,
                        stat.lobes[0].shape);
  }
  // Mean squares over 60 draws: 1 within four times sqrt(2 / 60), above all not far below.
  for (const double mean_square : {distance, ambient, shininess}) {
    EXPECT_GT(mean_square, 0.35);
    EXPECT_LT(mean_square, 1.75);
  }
  // Two coordinates, the sigma being that of the longer axis.
  EXPECT_GT(direction, 0.6);
  EXPECT_LT(direction, 2.8);
}

}  // namespace
}  // namespace turnlight::estimator::uncertainty
