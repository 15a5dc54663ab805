// Proves: what a calibration may have wrong is carried to first order into a result's error budget:
// item by item the sigma is that of whole estimates with the calibration moved by one sigma, on a
// sphere and on a mesh that shadows itself; squares add up to sigma_total's. Does not prove that
// stated covariances are right, nor what is beyond first order: the study of coverage does.
#include "estimator/from_session/calibration_errors.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <memory>
#include <optional>

#include "estimator/from_session/session_estimate.h"
#include "estimator/model/tangent_basis.h"
#include "tests/estimator/from_session/calibrated_scene.h"
#include "tests/temporary_folder.h"

namespace turnlight::estimator::from_session {
namespace {

// What is compared of two estimates.
Eigen::VectorXd Values(const Estimate& estimate, const Estimate& at) {
  Eigen::VectorXd out(6 * static_cast<Eigen::Index>(at.lights.size()) + 3);
  Eigen::Index i = 0;
  for (std::size_t l = 0; l < at.lights.size(); ++l) {
    const LightEstimate& light = estimate.lights[l];
    out.segment<2>(i) =
        model::TangentBasis(at.lights[l].light.direction).transpose() * light.light.direction;
    out[i + 2] = light.light.inverse_distance;
    out.segment<3>(i + 3) = light.diffuse_product;
    i += 6;
  }
  out.tail<3>() << estimate.reflectance.lobes[0].strength, estimate.reflectance.lobes[0].shape,
      estimate.reflectance.ambient;
  return out;
}

class Carried : public testing::Test {
 protected:
  void Prepare(const rig::sim::SyntheticTarget& target, const rig::CalibrationCovariances& known) {
    scene_ = MakeCalibratedScene(SmallRig(target), 6);
    scene_->calibration.covariances = known;
    session_ = WriteCalibrated(*scene_, scene_->calibration, 3, folder_.path());
    auto estimated = EstimateSession(folder_.path());
    ASSERT_TRUE(estimated) << estimated.error().text;
    estimated_ = std::make_unique<SessionEstimate>(std::move(*estimated));
    ASSERT_EQ(estimated_->output.estimate.lights.size(), 2u);
    for (std::size_t i = 0; i < session_.frames.size(); ++i) frames_.push_back(i);
    errors_ = ErrorsOf(scene_->calibration, session_, frames_, estimated_->geometry);
  }

  // The estimate with the calibration moved.
  Eigen::VectorXd Moved(std::size_t item, std::size_t direction, double sigmas) const {
    const MovedCalibration moved = errors_.move(item, direction, sigmas);
    std::vector<model::Keyframe> keyframes;
    for (std::size_t k = 0; k < estimated_->keyframes.size(); ++k) {
      keyframes.push_back(estimated_->keyframes.read(k).value());
      keyframes[k].X_WC = moved.poses[k].X_WC;
      keyframes[k].X_WT = moved.poses[k].X_WT;
      if (moved.radiance) keyframes[k].image.radiance = *moved.radiance(k);
    }
    const Estimate& base = estimated_->output.estimate;
    EstimateOptions options;
    options.warm_start = base.ToScene();
    options.model.specular = base.reflectance.lobes[0].model;
    options.model.diffuse = base.reflectance.diffuse_model;
    options.model.near = true;
    options.model.changing = options.model.harmonics = false;
    const auto again = EstimateScene(
        keyframes, estimated_->geometry,
        calib::RayGrid(moved.lens ? *moved.lens : *estimated_->session.camera), options);
    EXPECT_TRUE(again) << again.error().text;
    return Values(again->estimate, base);
  }

  // The covariance of what is compared, by whole estimates.
  Eigen::MatrixXd ByForce(std::size_t item) const {
    Eigen::MatrixXd sum;
    for (std::size_t d = 0; d < errors_.items[item].directions; ++d) {
      const Eigen::VectorXd shift = 0.5 * (Moved(item, d, 1.0) - Moved(item, d, -1.0));
      if (sum.size() == 0) sum = Eigen::MatrixXd::Zero(shift.size(), shift.size());
      sum += shift * shift.transpose();
    }
    return sum;
  }

  // Within a share, or within a twentieth of sigma_total, below which a solve is not that exact.
  void ExpectCarried(double share) const {
    const Estimate& estimate = estimated_->output.estimate;
    for (std::size_t item = 0; item < errors_.items.size(); ++item) {
      const std::string& name = errors_.items[item].words.item;
      SCOPED_TRACE(name);
      const uncertainty::Uncertainty* said = nullptr;
      for (const auto& part : estimate.budget)
        if (part.words.item == name) said = &part.sigma;
      ASSERT_NE(said, nullptr);
      const Eigen::MatrixXd force = ByForce(item);
      const auto near = [&](double value, Eigen::Index i, double total, const char* what) {
        const double sigma = std::sqrt(force(i, i));
        EXPECT_NEAR(value, sigma, std::max(share * sigma, 0.05 * total)) << what;
      };
      for (std::size_t l = 0; l < 2; ++l) {
        const Eigen::Index i = 6 * static_cast<Eigen::Index>(l);
        const LightEstimate& light = estimate.lights[l];
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(force.block<2, 2>(i, i));
        const Eigen::Vector2d sigma = axes.eigenvalues().cwiseMax(0.0).cwiseSqrt();
        // Along the total's larger axis, which lies between the item's own.
        const double least = 0.05 * light.direction_sigma, direction = said->lights[l].direction;
        EXPECT_GT(direction, (1.0 - share) * sigma[0] - least) << "direction";
        EXPECT_LT(direction, (1.0 + share) * sigma[1] + least) << "direction";
        near(said->lights[l].inverse_distance, i + 2, light.inverse_distance_sigma, "distance");
        near(said->lights[l].diffuse_product[0], i + 3, light.diffuse_product_sigma[0], "product");
      }
      const Eigen::Index last = force.rows();
      near(said->lobes[0].strength, last - 3, estimate.sigma.lobes[0].strength, "specular");
      near(said->lobes[0].shape, last - 2, *estimate.sigma.lobes[0].shape, "shininess");
      near(said->ambient, last - 1, estimate.sigma.ambient, "ambient");
    }
  }

  // Squares of all items against sigma_total's.
  void ExpectSquaresAddUp() const {
    const Estimate& estimate = estimated_->output.estimate;
    const auto check = [&](double total, const auto& of, const char* what) {
      double sum = 0.0;
      for (const auto& item : estimate.budget) sum += of(item.sigma) * of(item.sigma);
      EXPECT_NEAR(sum, total * total, 1e-9 * total * total) << what;
    };
    using uncertainty::Uncertainty;
    for (std::size_t l = 0; l < estimate.lights.size(); ++l) {
      const LightEstimate& light = estimate.lights[l];
      check(
          light.direction_sigma, [l](const Uncertainty& u) { return u.lights[l].direction; },
          "direction");
      check(
          light.inverse_distance_sigma,
          [l](const Uncertainty& u) { return u.lights[l].inverse_distance; }, "inverse distance");
      check(
          *light.distance_sigma, [l](const Uncertainty& u) { return u.lights[l].distance; },
          "distance");
      check(
          light.diffuse_product_sigma[1],
          [l](const Uncertainty& u) { return u.lights[l].diffuse_product[1]; }, "product");
    }
    check(
        *estimate.sigma.lobes[0].shape, [](const Uncertainty& u) { return u.lobes[0].shape; },
        "shininess");
    check(
        estimate.sigma.albedo[1], [](const Uncertainty& u) { return u.albedo[1]; }, "albedo");
    check(
        estimate.sigma.diffuse, [](const Uncertainty& u) { return u.diffuse; }, "diffuse");
  }

  TemporaryFolder folder_;
  std::optional<CalibratedScene> scene_;
  rig::Session session_;
  std::unique_ptr<SessionEstimate> estimated_;
  std::vector<std::size_t> frames_;
  CalibrationErrors errors_;
};

TEST_F(Carried, IntoTheBudgetOfASphereAsWholeEstimatesAre) {
  Prepare(calib::SphereShape{50.0}, ExampleCovariances());
  ASSERT_FALSE(HasFailure());
  ExpectCarried(0.15);
  ExpectSquaresAddUp();
}

TEST_F(Carried, IntoTheBudgetOfAMeshAsWholeEstimatesAre) {
  rig::sim::Blob blob;
  blob.radius = 50.0;
  blob.segments = 32;
  rig::CalibrationCovariances known;
  known.X_AT = PoseCovariance(0.1, 0.15);
  Prepare(blob, known);
  ASSERT_FALSE(HasFailure());
  ExpectCarried(0.2);
  ExpectSquaresAddUp();
}

}  // namespace
}  // namespace turnlight::estimator::from_session
