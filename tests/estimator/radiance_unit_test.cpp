// Proves: pictures times 2^-12 and 2^12 give the same estimate, bit for bit: what is a radiance
// times that factor, with its sigmas and its share of the error budget, and nothing else; at once
// and while keyframes come. Does not prove that an estimate does not depend on the exposure at
// large: thresholds are shares of the level (unknown_errors_test).
#include "estimator/observe/radiance_unit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "estimator/anytime.h"
#include "estimator/estimate.h"
#include "tests/estimator/random_observations.h"
#include "tests/estimator/tiny_ball.h"

namespace turnlight::estimator {
namespace {

using Values = std::vector<double>;

void Append(const Eigen::MatrixXd& from, Values& to) {
  to.insert(to.end(), from.data(), from.data() + from.size());
}

void Append(const uncertainty::Uncertainty& of, Values& radiances, Values& others) {
  for (const double value : {of.ambient, of.diffuse, of.lobes[0].strength})
    radiances.push_back(value);
  Append(of.ambient_product, radiances);
  for (const uncertainty::LightSigma& light : of.lights) {
    Append(light.diffuse_product, radiances);
    radiances.push_back(light.specular_product[0]);
    for (const double value :
         {light.direction, light.inverse_distance, light.intensity, light.distance})
      others.push_back(value);
    Append(light.position_covariance, others);
  }
  Append(of.albedo, others);
  for (const double value : {of.lobes[0].shape, of.roughness, of.condition})
    others.push_back(value);
}

// All numbers of an estimate: those that are radiances, and the others.
std::pair<Values, Values> NumbersOf(const Estimate& e) {
  Values radiances{e.reflectance.ambient,
                   e.reflectance.diffuse,
                   e.reflectance.lobes[0].strength,
                   e.sigma.ambient,
                   e.sigma.diffuse,
                   e.sigma.lobes[0].strength,
                   e.initial_rms,
                   e.rms};
  Append(e.ambient_product, radiances);
  Append(e.ambient_product_sigma, radiances);
  Values others{e.reflectance.lobes[0].shape, e.sigma.lobes[0].shape.value_or(0.0), e.condition,
                static_cast<double>(e.pixels), static_cast<double>(e.distinct_views)};
  Append(e.reflectance.albedo, others);
  Append(e.sigma.albedo, others);
  for (const LightEstimate& light : e.lights) {
    Append(light.diffuse_product, radiances);
    Append(light.diffuse_product_sigma, radiances);
    radiances.push_back(light.specular_product[0]);
    radiances.push_back(light.specular_product_sigma[0]);
    Append(light.light.direction, others);
    for (const double value :
         {light.light.inverse_distance, light.light.intensity, light.direction_sigma,
          light.inverse_distance_sigma, light.intensity_sigma.value_or(0.0),
          light.distance.value_or(0.0), light.distance_sigma.value_or(0.0)})
      others.push_back(value);
  }
  Append(e.stat, radiances, others);
  for (const uncertainty::BudgetItem& item : e.budget) Append(item.sigma, radiances, others);
  for (const IterationRecord& record : e.history) radiances.push_back(record.rms);
  return {radiances, others};
}

// NaN is the same as NaN.
void ExpectSame(Values expected, const Values& found, double factor) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i)
    EXPECT_TRUE(found[i] == factor * expected[i] ||
                (std::isnan(found[i]) && std::isnan(expected[i])))
        << i << ": " << found[i] << " for " << factor << " times " << expected[i];
}

void ExpectTimes(double factor, const Estimate& expected, const Estimate& found) {
  const auto [radiances, others] = NumbersOf(expected);
  const auto [found_radiances, found_others] = NumbersOf(found);
  ExpectSame(radiances, found_radiances, factor);
  ExpectSame(others, found_others, 1.0);
  ASSERT_EQ(found.ladder.size(), expected.ladder.size());
  for (std::size_t i = 0; i < found.ladder.size(); ++i)
    EXPECT_EQ(found.ladder[i].why, expected.ladder[i].why);
  EXPECT_EQ(found.undetermined, expected.undetermined);
  EXPECT_EQ(found.notes.size(), expected.notes.size() + 1);
  EXPECT_EQ(std::count_if(found.notes.begin(), found.notes.end(),
                          [](const Note& note) { return note.code == "exposure"; }),
            1);
}

// The brightest radiance is about `factor`.
TinyBall BallTimes(double factor, int views) {
  TinyBall ball(TwoLights(), views, 0.003);
  for (model::Keyframe& keyframe : ball.keyframes) keyframe.image.radiance *= 2.0 * factor;
  return ball;
}

// A calibration that may have the pictures' gain wrong, by 1 %.
CalibrationErrors GainErrors(const TinyBall& ball) {
  CalibrationErrors errors;
  errors.items = {{{"gain", "the gain", ""}, 1}};
  errors.move = [&ball](std::size_t, std::size_t, double sigmas) {
    MovedCalibration moved;
    for (const model::Keyframe& keyframe : ball.keyframes)
      moved.poses.push_back({keyframe.X_WC, keyframe.X_WT});
    moved.radiance = [&ball, sigmas](std::size_t k) -> Result<cv::Mat> {
      return cv::Mat(ball.keyframes[k].image.radiance * (1.0 + 0.01 * sigmas));
    };
    return moved;
  };
  return errors;
}

Result<EstimateOutput> OutputOf(const TinyBall& ball) {
  const CalibrationErrors errors = GainErrors(ball);
  EstimateOptions options;
  options.calibration = &errors;
  options.residuals_of = [](std::size_t) { return std::vector<std::size_t>{1}; };
  return EstimateScene(ball.keyframes, ball.geometry, ball.rays, options);
}

TEST(RadianceUnit, IsNotSeenInAnEstimate) {
  const auto usual = OutputOf(BallTimes(1.0, 3));
  ASSERT_TRUE(usual) << usual.error().text;
  EXPECT_GT(usual->estimate.sigma.diffuse, 0.009 * usual->estimate.reflectance.diffuse)
      << "the gain's";
  for (const double factor : {std::exp2(-12.0), std::exp2(12.0)}) {
    const auto output = OutputOf(BallTimes(factor, 3));
    ASSERT_TRUE(output) << output.error().text;
    ExpectTimes(factor, usual->estimate, output->estimate);
    EXPECT_EQ(output->noise, factor * usual->noise);
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_EQ(output->frame_rms[k], factor * usual->frame_rms[k]);
    const cv::Mat1f map = usual->map.intensity * factor;
    EXPECT_EQ(std::memcmp(map.data, output->map.intensity.data, map.total() * sizeof(float)), 0);
    const cv::Mat1f residual = usual->residuals.at(1) * factor;
    EXPECT_EQ(
        std::memcmp(residual.data, output->residuals.at(1).data, residual.total() * sizeof(float)),
        0);
  }
}

TEST(RadianceUnit, IsNotSeenWhileKeyframesCome) {
  const TinyBall usual = BallTimes(1.0, 3);
  AnytimeEstimator expected(usual.geometry, usual.rays, usual.camera);
  for (const double factor : {std::exp2(-12.0), std::exp2(12.0)}) {
    const TinyBall ball = BallTimes(factor, 3);
    AnytimeEstimator estimator(ball.geometry, ball.rays, ball.camera);
    for (std::size_t k = 0; k < 3; ++k) {
      estimator.Add(ball.keyframes[k]);
      ASSERT_TRUE(estimator.Step());
      if (expected.keyframes() <= k) {
        expected.Add(usual.keyframes[k]);
        ASSERT_TRUE(expected.Step());
      }
    }
    ExpectTimes(factor, *expected.Current(), *estimator.Current());
  }
}

}  // namespace
}  // namespace turnlight::estimator
