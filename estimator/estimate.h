// From keyframes to lights and reflectance with error bars: the estimator's front door.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "calib/camera_model.h"
#include "estimator/geometry.h"
#include "estimator/initial_guess.h"
#include "estimator/intensity_map.h"
#include "estimator/keyframe.h"
#include "estimator/model_choice.h"
#include "estimator/model_selection.h"
#include "estimator/observations.h"
#include "estimator/scene.h"
#include "estimator/solver.h"
#include "estimator/uncertainty.h"

namespace turnlight::estimator {

struct EstimateOptions {
  std::optional<InitialGuess> initial;
  // Goes on from an earlier estimate (in W) without looking for lights again.
  std::optional<Scene> warm_start;
  ModelChoice model;  // with a start or without
};

// Sigmas are sigma_total: see uncertainty.h.
struct LightEstimate {
  Light light;                   // about W's origin
  bool near = false;             // the data call for a finite distance
  double direction_sigma = 0.0;  // radians, larger axis of the tangent ellipse
  double inverse_distance_sigma = 0.0;
  std::optional<double> distance;  // given only for a near light
  std::optional<double> distance_sigma;
  std::optional<double> distance_min;  // 95 % bound; absent when the data give none
  std::optional<Eigen::Vector3d> position;
  std::optional<Eigen::Matrix3d> position_covariance;
  Eigen::Vector3d direction_at_reference = Eigen::Vector3d::UnitZ();
  std::optional<double> intensity_sigma;  // absent for the strongest light, which is the gauge
  // Products do not depend on the gauge: O k_d I_l (R, G, B) and k_s I_l.
  Eigen::Vector3d diffuse_product = Eigen::Vector3d::Zero();
  Eigen::Vector3d diffuse_product_sigma = Eigen::Vector3d::Zero();
  double specular_product = 0.0;
  double specular_product_sigma = 0.0;
};

struct ReflectanceSigma {
  Eigen::Vector3d albedo = Eigen::Vector3d::Zero();
  double ambient = 0.0, diffuse = 0.0, specular = 0.0;
  std::optional<double> shininess, roughness;
};

struct Note {
  std::string code;  // stable, such as "views-add-nothing"
  std::string text;
};
struct IterationRecord {
  int iteration = 0;
  double rms = 0.0;
};

struct Estimate {
  std::vector<LightEstimate> lights;  // strongest first; the strongest has intensity 1
  Reflectance reflectance;            // max(albedo) = 1; specular_model kNone if none was found
  ReflectanceSigma sigma;             // total, as all sigmas here
  Uncertainty stat;                   // their statistical parts, lights in the same order
  bool has_sigmas = true;             // false: the method states none, and all are NaN
  Eigen::Vector3d ambient_product = Eigen::Vector3d::Zero();  // O k_a
  Eigen::Vector3d ambient_product_sigma = Eigen::Vector3d::Zero();
  Eigen::Vector3d reference_point = Eigen::Vector3d::Zero();  // in W: centroid of what was observed
  int channels = 3;  // 1: grey pictures, the three channels repeat one value
  double initial_rms = 0.0;
  double rms = 0.0;  // over observed pixels and channels
  std::size_t pixels = 0;
  double condition = 0.0;  // of the column-scaled normal equations
  std::vector<std::string> weak;
  std::vector<Rung> ladder;
  std::vector<Note> notes;
  int views = 0;
  int distinct_views = 0;
  int iterations = 0;
  Stopped stopped = Stopped::kTolerance;  // why the last solve ended
  std::vector<IterationRecord> history;
  double initial_s = 0.0, solve_s = 0.0;  // seconds, for people

  Scene ToScene() const;
};

struct EstimateOutput {
  Estimate estimate;
  IntensityMap map;
  std::vector<cv::Mat1f>
      residuals;  // per keyframe: grey observed minus model; NaN where unobserved
};

// The estimate itself, from observations and the views' signatures (see views.h). On the way out,
// map and refined (both optional) receive what pictures and residual maps are made of. Fails with
// kNoEstimate when nothing usable was observed.
Result<Estimate> EstimateObservations(const Observations& all,
                                      const std::vector<cv::Mat>& signatures,
                                      const EstimateOptions& options, IntensityMap* map = nullptr,
                                      Refined* refined = nullptr);

// Fails with kNoEstimate, in words that say what to do, when nothing usable was observed:
// everything clipped, everything dark, nothing of the target in view.
Result<EstimateOutput> EstimateScene(const std::vector<Keyframe>& keyframes,
                                     const Geometry& geometry, const calib::RayGrid& rays,
                                     const EstimateOptions& options);

}  // namespace turnlight::estimator
