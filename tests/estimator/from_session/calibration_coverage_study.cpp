// Proves: over draws of a calibration from its stated covariance, correlations between its parts
// included, the errors of whole estimates are inside the stated sigma_total as often as they should
// be, and mostly outside of what it would be without the calibration's items. Does not prove that
// the covariances that a calibration states are right.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>

#include "base/random.h"
#include "estimator/from_session/session_estimate.h"
#include "tests/estimator/from_session/calibrated_scene.h"
#include "tests/temporary_folder.h"

namespace turnlight::estimator::from_session {
namespace {

// The errors of the lens and of the camera's pose go together.
rig::CalibrationCovariances Correlated() {
  rig::CalibrationCovariances known = ExampleCovariances();
  Eigen::MatrixXd joint = Eigen::MatrixXd::Zero(10, 10);
  joint.topLeftCorner(4, 4) = *known.camera_model;
  joint.bottomRightCorner(6, 6) = *known.X_WC;
  const Eigen::VectorXd sigma = joint.diagonal().cwiseSqrt();
  // A principal point that is off to the right is a camera that looks to the right.
  for (const auto& [a, b, correlation] : {std::tuple(2, 5, 0.6), {3, 4, -0.6}, {0, 9, 0.5}})
    joint(a, b) = joint(b, a) = correlation * sigma[a] * sigma[b];
  known.joint = rig::JointCovariance{{"camera_model", "X_WC"}, joint};
  return known;
}

Eigen::VectorXd Draw(const Eigen::MatrixXd& covariance, const RandomStream& random,
                     std::uint64_t& at) {
  Eigen::VectorXd normal(covariance.rows());
  for (double& value : normal) value = random.Normal(at++);
  return Eigen::LLT<Eigen::MatrixXd>(covariance).matrixL() * normal;
}

calib::Pose Moved(const calib::Pose& pose, const Eigen::VectorXd& by) {
  const Eigen::Vector3d w = by.head<3>();
  return {calib::Turn(w.normalized(), w.norm()).rotation * pose.rotation,
          pose.translation + by.tail<3>()};
}

// A calibration that is as wrong as it says.
rig::RigCalibration Drawn(rig::RigCalibration calibration, std::uint64_t seed) {
  const RandomStream random(seed, 77);
  std::uint64_t at = 0;
  const rig::CalibrationCovariances& known = calibration.covariances;
  const Eigen::VectorXd joint = Draw(known.joint->matrix, random, at);
  std::vector<double> intrinsics = calibration.lens.intrinsics();
  for (std::size_t i = 0; i < intrinsics.size(); ++i)
    intrinsics[i] += joint[static_cast<Eigen::Index>(i)];
  calibration.lens = calibration.lens.WithIntrinsics(intrinsics);
  calib::TurntableGeometry& rig = calibration.geometry;
  rig.X_WC = Moved(rig.X_WC, joint.tail<6>());
  rig.X_AT = Moved(rig.X_AT, Draw(*known.X_AT, random, at));
  rig.angle_scale += Draw(*known.angle_scale, random, at)[0];
  const Eigen::VectorXd levels = Draw(*known.radiometry, random, at);
  calibration.radiometry.black += levels[0];
  calibration.radiometry.white += levels[1];
  return calibration;
}

// Errors of one quantity in sigmas, with the calibration's items and without.
struct Tally {
  int draws = 0, one = 0, two = 0, one_without = 0;
  double squares = 0.0;
};

bool IsOfCalibration(const std::string& item) {
  for (const char* name :
       {"lens", "camera-pose", "axis", "target-place", "angle-scale", "angle-offset", "response"})
    if (item == name) return true;
  return false;
}

template <typename SigmaOf>
void Add(const Estimate& estimate, double error, double sigma, const SigmaOf& of, Tally& tally) {
  double without = 0.0;
  for (const auto& item : estimate.budget)
    if (!IsOfCalibration(item.words.item)) without += of(item.sigma) * of(item.sigma);
  const double ratio = std::abs(error) / sigma;
  ++tally.draws;
  tally.one += ratio <= 1.0 ? 1 : 0;
  tally.two += ratio <= 2.0 ? 1 : 0;
  tally.one_without += std::abs(error) <= std::sqrt(without) ? 1 : 0;
  tally.squares += ratio * ratio;
}

void Score(const Estimate& estimate, const model::Scene& truth,
           std::map<std::string, Tally>& tallies) {
  using uncertainty::Uncertainty;
  const model::Reflectance& material = truth.reflectance;
  for (std::size_t l = 0; l < 2; ++l) {
    const LightEstimate& light = estimate.lights[l];
    const std::string name = "light " + std::to_string(l + 1);
    const Eigen::Vector3d& direction = truth.lights[l].direction;
    Add(
        estimate, light.light.direction.cross(direction).norm(), light.direction_sigma,
        [l](const Uncertainty& u) { return u.lights[l].direction; }, tallies[name + " direction"]);
    Add(
        estimate, light.light.inverse_distance - truth.lights[l].inverse_distance,
        light.inverse_distance_sigma,
        [l](const Uncertainty& u) { return u.lights[l].inverse_distance; },
        tallies[name + " inverse distance"]);
    Add(
        estimate,
        light.diffuse_product[0] -
            material.albedo[0] * material.diffuse * truth.lights[l].intensity,
        light.diffuse_product_sigma[0],
        [l](const Uncertainty& u) { return u.lights[l].diffuse_product[0]; },
        tallies[name + " diffuse product"]);
  }
  Add(
      estimate, estimate.reflectance.lobes[0].shape - material.lobes[0].shape,
      *estimate.sigma.lobes[0].shape, [](const Uncertainty& u) { return u.lobes[0].shape; },
      tallies["shininess"]);
  Add(
      estimate, estimate.ambient_product[0] - material.albedo[0] * material.ambient,
      estimate.ambient_product_sigma[0], [](const Uncertainty& u) { return u.ambient_product[0]; },
      tallies["ambient product"]);
}

TEST(CalibrationCoverage, OfDrawsOfTheCalibration) {
  const char* const asked = std::getenv("TURNLIGHT_DRAWS");
  const int draws = asked ? std::atoi(asked) : 200;
  CalibratedScene scene = MakeCalibratedScene(SmallRig(calib::SphereShape{50.0}), 6);
  scene.calibration.covariances = Correlated();
  std::map<std::string, Tally> tallies;
  int usable = 0;
  for (int i = 0; i < draws; ++i) {
    const TemporaryFolder folder;
    WriteCalibrated(scene, Drawn(scene.calibration, static_cast<std::uint64_t>(i)),
                    static_cast<std::uint64_t>(i), folder.path());
    const auto estimated = EstimateSession(folder.path());
    ASSERT_TRUE(estimated) << estimated.error().text;
    const Estimate& estimate = estimated->output.estimate;
    if (estimate.lights.size() != 2 || !estimate.sigma.lobes[0].shape) continue;
    ++usable;
    Score(estimate, scene.studio.scene, tallies);
  }
  EXPECT_GE(usable, 9 * draws / 10) << "lights were found";
  std::printf("%-28s %7s %7s %9s %20s\n", "quantity", "1 sigma", "2 sigma", "rms/sigma",
              "1 sigma, without");
  for (const auto& [name, tally] : tallies) {
    const double count = tally.draws;
    std::printf("%-28s %6.1f%% %6.1f%% %9.2f %19.1f%%\n", name.c_str(), 100 * tally.one / count,
                100 * tally.two / count, std::sqrt(tally.squares / count),
                100 * tally.one_without / count);
    // Three sigmas of the binomial below 68.3 and 95.4 %; of a direction's ellipse the larger axis
    // holds more than 39.3 and less than 68.3 %.
    const bool direction = name.ends_with("direction");
    const auto least = [count](double share) {
      return share - 3.0 * std::sqrt(share * (1.0 - share) / count);
    };
    EXPECT_GE(tally.one / count, least(direction ? 0.393 : 0.683)) << name;
    EXPECT_GE(tally.two / count, least(direction ? 0.865 : 0.954)) << name;
  }
}

}  // namespace
}  // namespace turnlight::estimator::from_session
