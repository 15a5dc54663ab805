// From keyframes to lights and reflectance with error bars: the estimator's front door.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <map>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "base/stop_flag.h"
#include "calib/camera_model.h"
#include "estimator/calibration_errors.h"
#include "estimator/fit_state.h"
#include "estimator/model/initial_guess.h"
#include "estimator/model/keyframe.h"
#include "estimator/model/keyframe_source.h"
#include "estimator/model/model_choice.h"
#include "estimator/model/scene.h"
#include "estimator/observe/intensity_map.h"
#include "estimator/observe/observations.h"
#include "estimator/observe/observed_scene.h"
#include "estimator/observe/usable.h"
#include "estimator/photograph_estimate.h"
#include "estimator/select/model_selection.h"
#include "estimator/solve/solver.h"
#include "estimator/target/geometry.h"
#include "estimator/uncertainty/correlation.h"
#include "estimator/uncertainty/uncertainty.h"

namespace turnlight::estimator {

// The parts of an estimate, in their order; where lights are looked for once more, two of them come
// twice.
enum class Part {
  kObserve,  // keyframes read, and their pixels traced to the target
  kStart,    // lights looked for on a sample of the pixels
  kRefine,   // everything solved on all pixels, and its uncertainty
  kBudget,   // what the calibration's errors change; only with one
};

// How a caller follows an estimate and ends it.
struct Watch {
  // Set: the call ends soon, at the next iteration of whatever it solves, with kInterrupted.
  const StopFlag* stop = nullptr;
  std::function<void(Part)> on_part;  // called as each part begins, by the thread that estimates
  // Called for each keyframe once, in their order, while it is in memory; by the same thread.
  std::function<void(std::size_t keyframe, const model::Keyframe&)> on_keyframe;
};

struct EstimateOptions {
  std::optional<model::InitialGuess> initial;
  // Goes on from an earlier estimate (in W) without looking for lights again.
  std::optional<model::Scene> warm_start;
  model::ModelChoice model;  // with a start or without
  // What the keyframes' calibration may have wrong; must outlive the call. None: it is taken as
  // exact.
  const CalibrationErrors* calibration = nullptr;
  std::size_t most_pixels = observe::kMostPixels;  // of more, whole blocks are given up evenly
  // Of how many keyframes whose residual maps are made; none: no maps.
  std::function<std::vector<std::size_t>(std::size_t keyframes)> residuals_of;
  // The keyframes as the session counts them, for words; empty: 0, 1, ...
  std::vector<std::size_t> frame_numbers;
  Watch watch;
};

// Sigmas are sigma_total: see uncertainty.h.
struct LightEstimate {
  model::Light light;            // about W's origin
  bool near = false;             // the data call for a finite distance
  double direction_sigma = 0.0;  // radians, larger axis of the tangent ellipse
  double inverse_distance_sigma = 0.0;
  std::optional<double> distance;  // given only for a near light
  std::optional<double> distance_sigma;
  std::optional<double> distance_min;  // 95 % bound; absent when the data give none
  std::optional<Eigen::Vector3d> position;
  std::optional<Eigen::Matrix3d> position_covariance;
  // Per channel, the largest 1; of one light white by the gauge.
  Eigen::Vector3d colour_sigma = Eigen::Vector3d::Zero();  // 0 where it is white
  // Of the factors; NaN in a keyframe that does not see the light.
  std::vector<double> factor_sigma;
  Eigen::Vector3d direction_at_reference = Eigen::Vector3d::UnitZ();
  std::optional<double> intensity_sigma;  // absent for the strongest light, which is the gauge
  // Products do not depend on the gauge: O k_d I_l (R, G, B) and k_s I_l.
  Eigen::Vector3d diffuse_product = Eigen::Vector3d::Zero();
  Eigen::Vector3d diffuse_product_sigma = Eigen::Vector3d::Zero();
  std::array<double, model::kMostLobes> specular_product{};  // of each lobe
  std::array<double, model::kMostLobes> specular_product_sigma{};
};

struct ReflectanceSigma {
  Eigen::Vector3d albedo = Eigen::Vector3d::Zero();
  double ambient = 0.0, diffuse = 0.0;
  struct OfLobe {
    double strength = 0.0;
    std::optional<double> shape, f0;
  };
  std::array<OfLobe, model::kMostLobes> lobes{};
  std::optional<double> roughness;
  Eigen::Matrix<double, model::kHarmonics, 1> harmonics =
      Eigen::Matrix<double, model::kHarmonics, 1>::Zero();
  // Per channel, the largest 1 in the gauge of the lights' colours; 0 where all are white.
  Eigen::Vector3d ambient_colour = Eigen::Vector3d::Zero();
  Eigen::Vector3d specular_colour = Eigen::Vector3d::Zero();
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
  model::Reflectance reflectance;     // max(albedo) = 1; specular_model kNone if none was found
  ReflectanceSigma sigma;             // total, as all sigmas here
  uncertainty::Uncertainty stat;      // their statistical parts, lights in the same order
  std::vector<uncertainty::BudgetItem> budget;  // what the total ones are made of, item by item
  uncertainty::Correlation correlation;         // of their errors; none of the lights' factors
  uncertainty::CountEvidence count;             // of lights that may be missing
  bool has_sigmas = true;                       // false: the method states none, and all are NaN
  Eigen::Vector3d ambient_product = Eigen::Vector3d::Zero();  // O k_a
  Eigen::Vector3d ambient_product_sigma = Eigen::Vector3d::Zero();
  Eigen::Vector3d reference_point = Eigen::Vector3d::Zero();  // in W: centroid of what was observed
  int channels = 3;  // 1: grey pictures, the three channels repeat one value
  double initial_rms = 0.0;
  double rms = 0.0;  // over observed pixels and channels
  std::size_t pixels = 0;
  double condition = 0.0;  // of the column-scaled normal equations
  std::vector<std::string> weak;
  std::vector<model::Rung> ladder;
  std::vector<Note> notes;
  // Keys of result.json, such as "reflectance/diffuse" or "lights/1/intensity", of which the sigma
  // says that nothing is known: they are null there. See determined.h.
  std::vector<std::string> undetermined;
  // The keyframes as the session counts them; empty where nobody said.
  std::vector<std::size_t> frames;
  int views = 0;
  int distinct_views = 0;
  int iterations = 0;
  solve::Stopped stopped = solve::Stopped::kTolerance;  // why the last solve ended
  std::vector<IterationRecord> history;
  double initial_s = 0.0, solve_s = 0.0;  // seconds, for people
  FitState fit;                           // of methods with sigmas

  model::Scene ToScene() const;
};

// Of how many frames that were left out a map is made.
inline constexpr std::size_t kMostLeftOutMaps = 3;

struct EstimateOutput {
  Estimate estimate;
  observe::IntensityMap map;
  // By keyframe, of those that were asked for: grey observed minus model; NaN where unobserved.
  std::map<std::size_t, cv::Mat1f> residuals;
  // The same of frames that were left out because they do not belong to the others, by the number
  // that they have in the session.
  std::map<std::size_t, cv::Mat1f> left_out;  // of at most kMostLeftOutMaps of them
  double noise = 0.0;                         // sigma of a value, of white
  std::vector<double> frame_rms;  // of what the model leaves of each keyframe, of white; 0 of none
};

// What is known beside the observations: a refusal's words follow from it.
struct Evidence {
  observe::FlagCounts counts;  // of the target's pixels
  int copies = 0;              // views that are copies of others (view_evidence.h)
};

// How a fit of these observations answers to the calibration's errors; nothing: they are none.
using CalibrationAsked = std::function<Result<std::optional<uncertainty::CalibrationResponse>>(
    const observe::Observations& all, const solve::Solution& solution)>;

// The estimate itself, from observations and the views' signatures (see views.h; in white). On the
// way out, map and refined (both optional) receive what pictures and residual maps are made of;
// refined is in the observations' coordinates and radiance unit. calibration
// (optional) is asked once, at the solution; photograph (optional) where the first fit leaves more
// than noise: what it says the pictures are is then estimated instead. Fails with kNoEstimate when
// nothing usable was observed, with kInterrupted when options.watch.stop was set, and as
// `calibration` does. What was held back of the observations may be taken in (clipped_rung.h).
Result<Estimate> EstimateObservations(
    observe::Observations& all, const std::vector<cv::Mat>& signatures,
    const EstimateOptions& options, observe::IntensityMap* map = nullptr,
    select::Refined* refined = nullptr, const CalibrationAsked& calibration = {},
    const Evidence& evidence = {}, const PhotographAsked& photograph = {});

// Reads each keyframe once, a few at a time. Fails as the source does; with kNoEstimate, in words
// that say what to do, when nothing usable was observed: everything clipped, everything dark,
// nothing of the target in view; with kInterrupted when options.watch.stop was set.
Result<EstimateOutput> EstimateScene(const model::KeyframeSource& keyframes,
                                     const target::Geometry& geometry, const calib::RayGrid& rays,
                                     const EstimateOptions& options);
// The same, of keyframes in memory.
Result<EstimateOutput> EstimateScene(const std::vector<model::Keyframe>& keyframes,
                                     const target::Geometry& geometry, const calib::RayGrid& rays,
                                     const EstimateOptions& options);

}  // namespace turnlight::estimator
