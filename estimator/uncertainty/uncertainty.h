// From the normal equations at a solution to standard deviations of what is reported.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "estimator/model/scene.h"
#include "estimator/observe/observations.h"
#include "estimator/solve/solver.h"
#include "estimator/uncertainty/budget.h"
#include "estimator/uncertainty/direction_forecast.h"
#include "estimator/uncertainty/reported.h"
#include "estimator/uncertainty/residual_splits.h"

namespace turnlight::estimator::uncertainty {

// Standard deviations of the same quantities; NaN where the data do not determine one.
struct LightSigma {
  double direction =
      0.0;  // radians: square root of the larger eigenvalue of the tangent covariance
  double inverse_distance = 0.0;
  double intensity = 0.0;
  Eigen::Matrix3d position_covariance = Eigen::Matrix3d::Zero();  // meaningful for rho > 0
  double distance = 0.0;
  double inverse_distance_at_reference = 0.0;  // 1/R
  Eigen::Vector3d diffuse_product = Eigen::Vector3d::Zero();
  std::array<double, model::kMostLobes> specular_product{};  // of each lobe
  Eigen::Vector3d colour = Eigen::Vector3d::Zero();
};
struct LobeSigma {
  double strength = 0.0, shape = 0.0, f0 = 0.0;
};
struct Uncertainty {
  std::vector<LightSigma> lights;
  Eigen::Vector3d albedo = Eigen::Vector3d::Zero();
  double ambient = 0.0, diffuse = 0.0, roughness = 0.0;
  std::array<LobeSigma, model::kMostLobes> lobes{};
  Eigen::Vector3d ambient_product = Eigen::Vector3d::Zero();
  Eigen::Matrix<double, model::kHarmonics, 1> harmonics =
      Eigen::Matrix<double, model::kHarmonics, 1>::Zero();
  Eigen::Vector3d ambient_colour = Eigen::Vector3d::Zero();
  Eigen::Vector3d specular_colour = Eigen::Vector3d::Zero();
  double condition = 0.0;         // of the column-scaled normal equations, free columns
  std::vector<std::string> weak;  // directions in parameter space that hardly change the pictures
};

// One item's share of all sigmas. That of a direction is along the larger axis of its total tangent
// covariance, so that squares add up there too.
struct BudgetItem {
  BudgetWords words;
  Uncertainty sigma;
};

// What the pictures say for more lights, by score tests (score_test.h), in sigmas of what noise and
// residuals that go together leave; 0 where nothing speaks for it.
struct CountEvidence {
  double further = 0.0;                                          // that there is one more
  Eigen::Vector3d further_direction = Eigen::Vector3d::UnitZ();  // in W, one of a few
  double split = 0.0;  // that a light is two, or an extended one
  std::size_t split_light = 0;
};

// sigma_total^2 = sigma_stat^2 + sigma_model^2.
struct Uncertainties {
  Uncertainty total, stat;
  // That the total is of, over the vector in quantities.h; NaN where the data do not determine a
  // quantity.
  Eigen::MatrixXd covariance;
  Uncertainty calibration;         // the calibration's share, which is in the total
  std::vector<BudgetItem> budget;  // the noise first; items of nothing are left out
  // Statistical, of the lights' factors in each keyframe, in the order of the lights; none of
  // lights that are constant.
  std::vector<std::vector<double>> factors;
  DirectionForecast forecast;  // lights in the order of the others
  CountEvidence count;
};

// Statistical: the larger of s^2 H^-1 with H = J^T J, s^2 = sum r^2 / (values - parameters), and
// H^-1 (sum g g^T) H^-1 over the gradients g of tiles of neighbouring pixels (Huber's "sandwich",
// clustered), which is larger where neighbours' residuals go together, or those of one place in the
// pictures; each as far as it is beyond chance.
// Model: for each split of the observations in two halves, half the difference d of what they ask
// for, to first order; it counts as far as it is more than noise: all parameters together (chi
// squared, 4 sigma), or a quantity by itself (3 sigma); and twice, for both halves have errors in
// common. Besides, the change when footprints are sampled twice as finely; when a near light's
// falloff is averaged over the pixels; when pixels near attached shadows' edges are left out; and
// when what was left out of the model, but is there beyond noise, is let in: roughness, the inverse
// distance of a light held to be distant, and what unmodelled.h tries. Texture is in the diffuse
// and ambient values. Squares add up. Carried to the reported quantities by their
// derivatives (central differences). What ended at a bound counts as free, so that a light that
// looks distant still has a sigma. splits: of this solution. views_per_distinct: what repeats tells
// nothing new, and covariances are as much larger. calibration (optional): its items are parts of
// the total, and of a light that is held distant its inverse distance's too.
Uncertainties EstimateUncertainty(const solve::Solution& solution,
                                  const observe::Observations& observations,
                                  const std::vector<std::size_t>& order, double views_per_distinct,
                                  const ResidualSplits& splits,
                                  const CalibrationResponse* calibration = nullptr);

}  // namespace turnlight::estimator::uncertainty
