// Proves: the paper's clusters, start, ranges and cost are as documented; the gradient of its cost
// is that of an independent formula in Ceres Jets, and by hand for one pixel; the descent never
// raises the cost, stays within the ranges, and finds a scene that its model contains; the same
// bits for any number of threads. Does not prove that the method is a good one:
// docs/paper_method.md measures that.
#include "estimator/baseline/paper_method.h"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/angles.h"
#include "base/parallel.h"
#include "estimator/baseline/paper_estimate.h"
#include "estimator/estimate.h"
#include "rig/sim/synthetic_session.h"
#include "tests/estimator/random_observations.h"
#include "tests/estimator/small_scene.h"

namespace turnlight::estimator::baseline {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

Vector3d FromAngles(double zenith_deg, double azimuth_deg) {
  const double z = DegToRad(zenith_deg), a = DegToRad(azimuth_deg);
  return {std::sin(z) * std::cos(a), std::sin(z) * std::sin(a), std::cos(z)};
}

std::vector<observe::MapPoint> OnTheEquator(const std::vector<double>& azimuths_deg) {
  std::vector<observe::MapPoint> points;
  for (const double azimuth : azimuths_deg) points.push_back({FromAngles(90.0, azimuth), 1.0});
  return points;
}

TEST(ClustersTest, APointJoinsTheFirstLeaderWithinReach) {
  // 22 is nearer to the second leader, 30, and joins the first.
  const auto clusters = ClustersOf(OnTheEquator({0.0, 30.0, 22.0, 50.0, 0.0}), DegToRad(25.0));
  ASSERT_EQ(clusters.size(), 2u);
  EXPECT_EQ(clusters[0].cells, 3u);
  EXPECT_EQ(clusters[1].cells, 2u);
  EXPECT_LT(AngleDeg(clusters[0].leader, FromAngles(90.0, 0.0)), 1e-6);
  EXPECT_LT(AngleDeg(clusters[1].centroid, FromAngles(90.0, 40.0)), 1e-6);
}

TEST(ClustersTest, TheirNumberDependsOnTheOrder) {
  EXPECT_EQ(ClustersOf(OnTheEquator({0.0, 20.0, 40.0}), DegToRad(25.0)).size(), 2u);
  EXPECT_EQ(ClustersOf(OnTheEquator({20.0, 0.0, 40.0}), DegToRad(25.0)).size(), 1u);
}

TEST(ClustersTest, AnEmptyMapIsRefused) {
  observe::IntensityMap map;
  map.intensity = cv::Mat1f(180, 360, std::numeric_limits<float>::quiet_NaN());
  const auto solution = SolveByPaper(RandomObservations(300, 3, 1).observations, map, {}, nullptr);
  ASSERT_FALSE(solution);
  EXPECT_EQ(solution.error().kind, ErrorKind::kNoEstimate);
  EXPECT_NE(solution.error().text.find("the paper's intensity map is empty: move the camera"),
            std::string::npos);
}

// A map with a Gaussian spot of 5 degrees at each place, on a floor of 0.1.
struct Spot {
  Vector3d direction;
  double height;
};

observe::IntensityMap MapOf(const std::vector<Spot>& spots) {
  observe::IntensityMap map{cv::Mat1f(180, 360, 0.1f)};
  for (int row = 0; row < 180; ++row)
    for (int column = 0; column < 360; ++column)
      for (const Spot& spot : spots) {
        const double angle = AngleDeg(observe::MapDirection(row, column), spot.direction) / 5.0;
        map.intensity(row, column) +=
            static_cast<float>(spot.height * std::exp(-0.5 * angle * angle));
      }
  return map;
}

TEST(ClustersTest, BrightSpotsOfTheUpperHalfAreFound) {
  const std::vector<Spot> spots = {{FromAngles(30.0, 40.0), 1.0},
                                   {FromAngles(60.0, 359.5), 0.8},
                                   {FromAngles(45.0, 200.0), 0.4},    // below half
                                   {FromAngles(120.0, 100.0), 3.0}};  // below the horizon
  const auto clusters = PaperClusters(MapOf(spots), Vector3d::UnitZ());
  ASSERT_EQ(clusters.size(), 2u);
  EXPECT_LT(AngleDeg(clusters[0].centroid, spots[0].direction), 0.5);
  EXPECT_LT(AngleDeg(clusters[1].centroid, spots[1].direction), 0.5);
  // With another zenith the bright one is above the horizon, and alone above half of the range.
  const auto turned = PaperClusters(MapOf(spots), FromAngles(90.0, 100.0));
  ASSERT_EQ(turned.size(), 1u);
  EXPECT_LT(AngleDeg(turned[0].centroid, spots[3].direction), 0.5);
}

TEST(ClustersTest, NothingAboveTheHorizonIsAnError) {
  const RandomObservations random(256, 3, 1);
  observe::IntensityMap map{cv::Mat1f(180, 360, std::numeric_limits<float>::quiet_NaN())};
  map.intensity(120, 7) = 1.0f;
  const auto solution = SolveByPaper(random.observations, map, {});
  ASSERT_FALSE(solution);
  EXPECT_EQ(solution.error().kind, ErrorKind::kNoEstimate);
  EXPECT_NE(solution.error().text.find("90 degrees"), std::string::npos);
}

TEST(PaperUpTest, NormalOfThePlaneElseTheWorldsAxis) {
  std::vector<calib::RigPoses> poses(2);
  poses[0].X_WT.rotation = Eigen::AngleAxisd(0.3, Vector3d::UnitX()).matrix();
  poses[1].X_WT.rotation = Eigen::AngleAxisd(-0.3, Vector3d::UnitX()).matrix();
  const target::Geometry plane(calib::PlaneShape{});
  EXPECT_LT(AngleDeg(PaperUp(poses, plane), Vector3d::UnitZ()), 1e-6);
  poses.pop_back();
  EXPECT_LT(AngleDeg(PaperUp(poses, plane), poses[0].X_WT.rotation.col(2)), 1e-6);
  EXPECT_EQ(PaperUp(poses, target::Geometry(calib::SphereShape{})), Vector3d::UnitZ());
  poses.resize(2);
  poses[0].X_WT.rotation = Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitX()).matrix();
  poses[1].X_WT.rotation = Eigen::AngleAxisd(-M_PI / 2, Vector3d::UnitX()).matrix();
  EXPECT_EQ(PaperUp(poses, plane), Vector3d::UnitZ());
}

// One pixel at the reference, seen and lit along its normal: S = O (k_a + k_d / s^2) + k_s / s^2.
TEST(PaperCostTest, OnePixelByHand) {
  observe::Observations one = RandomObservations(1, 3, 1).observations;
  const double observed[3] = {0.2, 0.7, 0.4};
  for (int k = 0; k < 3; ++k) {
    one.position[k][0] = 0.0f;
    one.normal[k][0] = one.mirrored[k][0] = k == 2 ? 1.0f : 0.0f;
    one.radiance[k][0] = static_cast<float>(observed[k]);
  }
  const PaperProblem problem(one, {Vector3d::UnitZ()}, 10.0);
  ASSERT_EQ(problem.count(), 8);
  VectorXd x = problem.Start();
  for (int c = 0; c < 3; ++c) EXPECT_FLOAT_EQ(x[problem.Colour(c)], observed[c]);  // the median
  for (const int i :
       {problem.Ambient(), problem.Diffuse(), problem.Specular(), problem.Shininess()})
    EXPECT_EQ(x[i], 0.5);
  EXPECT_EQ(x[problem.Distance(0)], 1.0);

  const double s = 1.25, ka = 0.3, kd = 0.6, ks = 0.2;
  x << 0.4, 0.5, 0.9, ka, kd, ks, 0.7, s;
  VectorXd gradient;
  const double cost = problem.Cost(x, &gradient);
  double expected = 0.0, by_ka = 0.0, by_kd = 0.0, by_ks = 0.0, by_s = 0.0;
  for (int c = 0; c < 3; ++c) {
    const double model = x[c] * (ka + kd / (s * s)) + ks / (s * s);
    const double twice = 2.0 / 3.0 * (model - observed[c]);
    expected += (model - observed[c]) * (model - observed[c]) / 3.0;
    EXPECT_NEAR(gradient[c], twice * (ka + kd / (s * s)), 1e-6);
    by_ka += twice * x[c];
    by_kd += twice * x[c] / (s * s);
    by_ks += twice / (s * s);
    by_s += twice * -2.0 / (s * s * s) * (x[c] * kd + ks);
  }
  EXPECT_NEAR(cost, expected, 1e-6);
  EXPECT_NEAR(gradient[problem.Ambient()], by_ka, 1e-6);
  EXPECT_NEAR(gradient[problem.Diffuse()], by_kd, 1e-6);
  EXPECT_NEAR(gradient[problem.Specular()], by_ks, 1e-6);
  EXPECT_NEAR(gradient[problem.Shininess()], 0.0, 1e-6);  // at the lobe's centre
  EXPECT_NEAR(gradient[problem.Distance(0)], by_s, 1e-6);
}

constexpr int kMaxVariables = 9;
using Jet = ceres::Jet<double, kMaxVariables>;
using JetVector = Eigen::Matrix<Jet, 3, 1>;

// E and its derivatives, straight from the paper's model with lights at p = d u.
Jet JetCost(const RandomObservations& random, const std::vector<Vector3d>& directions,
            double ceiling_distance, const VectorXd& values) {
  const int channels = random.observations.channels;
  std::vector<Jet> x;
  for (Eigen::Index i = 0; i < values.size(); ++i) x.emplace_back(values[i], static_cast<int>(i));
  const Jet *k = &x[static_cast<std::size_t>(channels)], *distance = k + 4;
  Jet sum(0.0);
  for (std::size_t i = 0; i < random.points.size(); ++i) {
    const RandomPoint& point = random.points[i];
    Jet diffuse(0.0), specular(0.0);
    for (std::size_t l = 0; l < directions.size(); ++l) {
      const JetVector to_light = (directions[l].cast<Jet>() * (distance[l] * ceiling_distance) -
                                  point.position.cast<Jet>());
      const Jet squared = to_light.squaredNorm();
      const JetVector unit = to_light / sqrt(squared);
      const Jet irradiance = ceiling_distance * ceiling_distance / squared;
      const Jet nl = point.normal.cast<Jet>().dot(unit);
      if (nl.a <= 0.0) continue;
      const JetVector mirrored = point.normal.cast<Jet>() * (2.0 * nl) - unit;
      const Jet rv = mirrored.dot(point.viewer.cast<Jet>());
      diffuse += irradiance * nl;
      if (rv.a > 0.0) specular += irradiance * pow(rv, 128.0 * k[3]);
    }
    for (int c = 0; c < channels; ++c) {
      const Jet model = x[static_cast<std::size_t>(c)] * (k[0] + k[1] * diffuse) + k[2] * specular;
      const Jet residual = model - double{random.observations.radiance[c][i]};
      sum += residual * residual;
    }
  }
  return sum / static_cast<double>(random.points.size() * static_cast<std::size_t>(channels));
}

TEST(PaperCostTest, GradientIsThatOfJets) {
  const std::vector<Vector3d> directions = {FromAngles(30.0, 20.0), FromAngles(55.0, 200.0)};
  for (const int channels : {1, 3}) {
    const RandomObservations random(2000, channels, 5);
    const PaperProblem problem(random.observations, directions, 8.0);
    const RandomStream draws(11, 3);
    for (std::uint64_t trial = 0; trial < 5; ++trial) {
      VectorXd x(problem.count());
      for (int i = 0; i < problem.count(); ++i)
        x[i] = draws.Uniform(20 * trial + static_cast<std::uint64_t>(i), 0.1, 0.9);
      x[problem.Distance(1)] += 1.0;
      const Jet expected = JetCost(random, directions, 8.0, x);
      VectorXd gradient;
      EXPECT_NEAR(problem.Cost(x, &gradient) / expected.a, 1.0, 1e-5);
      EXPECT_EQ(problem.Cost(x, nullptr), problem.Cost(x, &gradient));
      const double scale = gradient.cwiseAbs().maxCoeff();
      for (int i = 0; i < problem.count(); ++i)
        EXPECT_NEAR(gradient[i], expected.v[i], 1e-5 * scale) << channels << " channels, " << i;
    }
  }
}

TEST(PaperRangesTest, ProjectionIsThatOfTable1) {
  const RandomObservations random(256, 3, 2);  // R = 1
  const PaperProblem problem(random.observations, {Vector3d::UnitZ()}, 10.0);
  const VectorXd low = problem.Projected(VectorXd::Constant(problem.count(), -3.0));
  const VectorXd high = problem.Projected(VectorXd::Constant(problem.count(), 7.0));
  for (int i = 0; i < problem.Shininess(); ++i) {
    EXPECT_EQ(low[i], 0.0);
    EXPECT_EQ(high[i], 1.0);
  }
  EXPECT_GT(low[problem.Shininess()], 0.0);
  EXPECT_LT(low[problem.Shininess()], 1e-4);
  EXPECT_EQ(high[problem.Shininess()], 1.0);
  EXPECT_NEAR(low[problem.Distance(0)], 0.1, 0.01);  // not within the target
  EXPECT_EQ(high[problem.Distance(0)], 7.0);         // no upper end
  const VectorXd inside = problem.Start();
  EXPECT_EQ(problem.Projected(inside), inside);
}

// A scene of the paper's model; lights as bright as their distance says.
model::Scene PaperScene(const std::vector<Vector3d>& directions,
                        const std::vector<double>& distances, double ceiling_distance) {
  model::Scene scene;
  for (std::size_t l = 0; l < directions.size(); ++l) {
    model::Light& light = scene.lights.emplace_back();
    light.direction = directions[l];
    light.inverse_distance = 1.0 / distances[l];
    light.intensity = std::pow(ceiling_distance / distances[l], 2);
  }
  model::Reflectance& r = scene.reflectance;
  r.albedo = {0.5, 0.4, 0.2};
  r.ambient = 0.2;
  r.diffuse = 0.7;
  r.lobes[0].strength = 0.3;
  r.lobes[0].shape = 30.0;
  return scene;
}

TEST(PaperDescentTest, NeverRaisesTheCostAndKeepsTheRanges) {
  // Brighter and sharper than the ranges allow.
  const std::vector<Vector3d> directions = {FromAngles(30.0, 20.0), FromAngles(55.0, 200.0)};
  model::Scene scene = PaperScene(directions, {9.0, 14.0}, 10.0);
  scene.reflectance.lobes[0].strength = 3.0;
  scene.reflectance.lobes[0].shape = 400.0;
  scene.reflectance.albedo = {1.8, 0.9, 0.0};
  scene.reflectance.ambient = 0.0;
  const RandomObservations random(3000, 3, 3, &scene);
  const PaperProblem problem(random.observations, directions, 10.0);
  const VectorXd start = VectorXd::Constant(problem.count(), 2.0);  // outside
  for (const int limit : {0, 1, 7, 100}) {
    const PaperDescent descent = Descend(problem, start, limit);
    EXPECT_LE(descent.iterations, limit);
    EXPECT_EQ(descent.cost_history.size(), static_cast<std::size_t>(descent.iterations) + 1);
    EXPECT_EQ(problem.Projected(descent.variables), descent.variables);
    EXPECT_EQ(problem.Cost(descent.variables, nullptr), descent.cost_history.back());
    for (std::size_t i = 1; i < descent.cost_history.size(); ++i)
      EXPECT_LT(descent.cost_history[i], descent.cost_history[i - 1]) << "iteration " << i;
  }
}

// Where n.l changes its sign the highlight, which has no factor n.l, jumps: a pixel that passes
// there moves the cost by a step, at which a descent may end before its time. Pictures have enough
// pixels for the steps to be small; a thousand points have not.
void LeaveOutTerminators(const std::vector<Vector3d>& directions, observe::Observations& all) {
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all.pixel[i] == observe::Observations::kNoPixel) continue;
    const Vector3d normal(all.normal[0][i], all.normal[1][i], all.normal[2][i]);
    const auto near = [&](const Vector3d& u) { return std::abs(normal.dot(u)) < 0.15; };
    if (std::none_of(directions.begin(), directions.end(), near)) continue;
    all.pixel[i] = observe::Observations::kNoPixel;
    --all.used;
  }
}

TEST(PaperDescentTest, FindsASceneOfItsModel) {
  const std::vector<Vector3d> directions = {FromAngles(30.0, 20.0), FromAngles(55.0, 200.0)};
  const model::Scene truth = PaperScene(directions, {9.0, 14.0}, 10.0);
  observe::Observations observations = RandomObservations(1000, 3, 3, &truth).observations;
  LeaveOutTerminators(directions, observations);
  const PaperProblem problem(observations, directions, 10.0);
  const PaperDescent few = Descend(problem, problem.Start(), 228);
  EXPECT_LT(few.cost_history.back(), 3e-3 * few.cost_history.front());
  // Steepest descent arrives slowly; with time it does.
  const PaperDescent many = Descend(problem, problem.Start(), 20000);
  EXPECT_LT(many.cost_history.back(), 1e-5 * many.cost_history.front());
  const model::Scene found = problem.ToScene(many.variables);
  const model::Reflectance &r = found.reflectance, &t = truth.reflectance;
  EXPECT_NEAR(r.lobes[0].shape, t.lobes[0].shape, 0.01 * t.lobes[0].shape);
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(r.albedo[c] * r.ambient, t.albedo[c] * t.ambient, 0.01 * t.albedo[c] * t.ambient);
  for (std::size_t l = 0; l < 2; ++l) {
    const double specular = t.lobes[0].strength * truth.lights[l].intensity;
    EXPECT_NEAR(r.lobes[0].strength * found.lights[l].intensity, specular, 0.01 * specular);
    for (int c = 0; c < 3; ++c) {
      const double product = t.albedo[c] * t.diffuse * truth.lights[l].intensity;
      EXPECT_NEAR(r.albedo[c] * r.diffuse * found.lights[l].intensity, product, 0.01 * product);
    }
  }
}

rig::sim::SyntheticConfig OneLight() {
  rig::sim::SyntheticConfig config =
      SmallBall({{.direction = {0.5, 0.2, 0.85}, .distance = 2800.0, .intensity = 0.8}},
                Glossy(0.1, 0.4, 0.5));
  config.sensor.noise_relative = 0.002;
  return config;
}

// level: what the pictures are multiplied by.
Result<EstimateOutput> RunPaper(const rig::sim::SyntheticSession& session, double level = 1.0) {
  auto keyframes = rig::sim::ToKeyframes(session);
  for (model::Keyframe& keyframe : keyframes)
    keyframe.image.radiance = keyframe.image.radiance * level;
  EstimateOptions options;
  options.residuals_of = [](std::size_t count) {
    std::vector<std::size_t> all(count);
    std::iota(all.begin(), all.end(), std::size_t{0});
    return all;
  };
  return EstimateByPaper(model::SourceOf(keyframes), target::Geometry(session.target),
                         calib::RayGrid(session.camera), {}, options);
}

TEST(PaperEstimateTest, OneLightOnASphere) {
  const auto session = rig::sim::SynthesizeInMemory(OneLight());
  ASSERT_TRUE(session) << session.error().text;
  const auto output = RunPaper(*session);
  ASSERT_TRUE(output) << output.error().text;
  const Estimate& e = output->estimate;
  ASSERT_EQ(e.lights.size(), 1u);
  const LightEstimate& light = e.lights[0];
  EXPECT_LT(AngleDeg(light.light.direction, session->scene.lights[0].direction), 5.0);
  EXPECT_TRUE(light.near);
  EXPECT_NEAR(light.light.intensity, std::pow(2500.0 / light.distance.value(), 2), 1e-9);
  EXPECT_FALSE(e.has_sigmas);
  EXPECT_TRUE(std::isnan(light.direction_sigma));
  EXPECT_FALSE(light.distance_sigma || light.distance_min || light.intensity_sigma);
  EXPECT_EQ(e.views, 6);
  EXPECT_EQ(e.distinct_views, 6);
  EXPECT_LE(e.iterations, 228);
  ASSERT_EQ(e.history.size(), static_cast<std::size_t>(e.iterations) + 1);
  EXPECT_EQ(e.history.front().rms, e.initial_rms);
  EXPECT_LT(e.rms, 0.2 * e.initial_rms);
  // The residual maps are those of this scene.
  double sum = 0.0, count = 0.0;
  for (const auto& [keyframe, map] : output->residuals)
    for (const float value : map) {
      if (std::isnan(value)) continue;
      sum += double{value} * double{value};
      count += 1.0;
    }
  EXPECT_EQ(count, static_cast<double>(e.pixels));
  EXPECT_LT(std::sqrt(sum / count), 1.1 * e.rms);
}

// Pictures far from white are fitted in a unit of their own.
TEST(PaperEstimateTest, DarkAndBrightPicturesGiveTheSameScene) {
  const auto session = rig::sim::SynthesizeInMemory(OneLight());
  ASSERT_TRUE(session) << session.error().text;
  const auto dark = RunPaper(*session, std::exp2(-12.0));
  const auto bright = RunPaper(*session, std::exp2(12.0));
  ASSERT_TRUE(dark && bright);
  const double factor = std::exp2(24.0);
  const Estimate &a = dark->estimate, &b = bright->estimate;
  ASSERT_EQ(a.lights.size(), 1u);
  ASSERT_EQ(b.lights.size(), 1u);
  EXPECT_EQ(b.lights[0].light.direction, a.lights[0].light.direction);
  EXPECT_EQ(b.lights[0].distance, a.lights[0].distance);
  EXPECT_EQ(b.lights[0].specular_product[0], factor * a.lights[0].specular_product[0]);
  EXPECT_EQ(b.lights[0].diffuse_product, factor * a.lights[0].diffuse_product);
  EXPECT_EQ(b.reflectance.albedo, a.reflectance.albedo);
  EXPECT_EQ(b.ambient_product, factor * a.ambient_product);
  EXPECT_EQ(b.distinct_views, a.distinct_views);
  EXPECT_EQ(b.iterations, a.iterations);
  EXPECT_EQ(b.initial_rms, factor * a.initial_rms);
  EXPECT_EQ(b.rms, factor * a.rms);
  EXPECT_LT(b.rms, 0.2 * b.initial_rms);
}

TEST(PaperEstimateTest, SameBitsWithAnyNumberOfThreads) {
  const auto session = rig::sim::SynthesizeInMemory(OneLight());
  ASSERT_TRUE(session);
  std::vector<double> first;
  for (const int threads : {1, 2, 7, 1}) {
    SetThreads(threads);
    const auto output = RunPaper(*session);
    ASSERT_TRUE(output);
    std::vector<double> all;
    for (const IterationRecord& record : output->estimate.history) all.push_back(record.rms);
    for (const LightEstimate& light : output->estimate.lights) {
      all.insert(all.end(), light.light.direction.data(), light.light.direction.data() + 3);
      all.push_back(light.light.inverse_distance);
    }
    all.push_back(output->estimate.reflectance.lobes[0].shape);
    if (first.empty()) first = all;
    EXPECT_EQ(all, first) << threads << " threads";
  }
  SetThreads(0);
}

}  // namespace
}  // namespace turnlight::estimator::baseline
