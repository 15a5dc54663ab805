#include "estimator/estimate.h"

#include <algorithm>
#include <string>
#include <utility>

#include "base/format.h"
#include "base/messages/messages.h"
#include "base/stopwatch.h"
#include "estimator/calibration_response.h"
#include "estimator/determined.h"
#include "estimator/exposure_level.h"
#include "estimator/notes.h"
#include "estimator/observe/radiance_statistics.h"
#include "estimator/observe/views.h"
#include "estimator/report.h"
#include "estimator/residual_maps.h"
#include "estimator/solve/coordinates.h"
#include "estimator/start/find_start.h"
#include "estimator/view_evidence.h"

namespace turnlight::estimator {
namespace {

constexpr double kMuchFromBehind = 0.1;  // of what is seen of the target
constexpr double kRoomForLight = 0.3;    // of white: pictures below it can be exposed longer

// Pictures without a light's share are ambient light alone, unless noise could hide one.
Status CheckLights(const Estimate& estimate, double noise, double brightest,
                   const Evidence& evidence) {
  if (!estimate.lights.empty()) return {};
  if (!Unexplained(estimate.rms, noise) && !Noisy(noise, brightest)) return {};
  const double bright = brightest * evidence.level;
  const messages::Values values{
      {"copies", std::to_string(evidence.copies)},
      {"views", Format("%d pictures", estimate.views)},
      {"behind", Format("%.0f", 100.0 * evidence.counts.from_behind)},
      {"rms", Format("%.2g", estimate.rms * evidence.level)},
      {"noise", Format("%.2g", noise * evidence.level)},
      {"share", Format("%.0f", 100.0 * noise / std::max(brightest, 1e-300))},
      {"bright", Format("%.2g", bright)}};
  if (evidence.copies > 0) return messages::Refuse("no-light/copies", values);
  if (evidence.counts.from_behind > kMuchFromBehind)
    return messages::Refuse("no-light/from-behind", values);
  if (!Noisy(noise, brightest)) return messages::Refuse("no-light/unexplained", values);
  return messages::Refuse(bright < kRoomForLight ? "no-light/dark" : "no-light/noisy", values);
}

start::Start StartOf(const observe::Observations& all, double noise,
                     const observe::IntensityMap& map, const EstimateOptions& options) {
  if (options.warm_start) return {solve::ToSolver(*options.warm_start, all), {}, {}};
  return start::FindStart(all, noise, map, options.initial, options.model, options.watch.stop);
}

void Tell(const Watch& watch, Part part) {
  if (watch.on_part) watch.on_part(part);
}

void TakeDecisions(start::Start& start, Estimate& out) {
  out.ladder = std::move(start.ladder);
  for (const double rms : start.rms_history)
    out.history.push_back({static_cast<int>(out.history.size()), rms});
}

// Gives how many views there are for each that differs from those before.
double CountViews(const std::vector<cv::Mat>& signatures, double noise, Estimate& out) {
  out.views = static_cast<int>(signatures.size());
  out.distinct_views = observe::DistinctViews(signatures, noise);
  return out.distinct_views > 0 ? static_cast<double>(out.views) / out.distinct_views : 1.0;
}

// The estimate of pictures that are far darker or brighter than white: at a level of about 1, then
// scaled back. Levels are powers of two: the observations are afterwards what they were.
Result<Estimate> EstimateAtLevel(observe::Observations& all, const std::vector<cv::Mat>& signatures,
                                 const EstimateOptions& options, double level,
                                 select::Refined* refined, const CalibrationAsked& calibration,
                                 Evidence evidence) {
  Scale(all, 1.0 / level);
  std::vector<cv::Mat> scaled_signatures;
  for (const cv::Mat& signature : signatures) scaled_signatures.emplace_back(signature / level);
  EstimateOptions scaled_options = options;
  if (scaled_options.warm_start) Scale(scaled_options.warm_start->reflectance, 1.0 / level);
  evidence.level = level;
  auto estimate = EstimateObservations(all, scaled_signatures, scaled_options, nullptr, refined,
                                       calibration, evidence);
  Scale(all, level);
  if (!estimate) return estimate;
  Scale(*estimate, level);
  AddNote("exposure", {{"level", Format("%.2g", level)}}, *estimate);
  if (refined) Scale(refined->solution.scene.reflectance, level);
  return estimate;
}

// own (optional): the same observations, which may be changed while the call lasts; else they are
// copied where that is needed.
Result<Estimate> EstimateWhatIsSeen(const observe::Observations& all, observe::Observations* own,
                                    const std::vector<cv::Mat>& signatures,
                                    const EstimateOptions& options, observe::IntensityMap* map,
                                    select::Refined* refined, const CalibrationAsked& calibration,
                                    const Evidence& evidence) {
  const Stopwatch stopwatch;
  if (const Status status = observe::CheckUsable(all); !status) return Forward(status);
  if (StopRequested(options.watch.stop)) return InterruptedError();
  observe::IntensityMap own_map;
  observe::IntensityMap& used_map = map ? *map : own_map;
  if (map || !options.warm_start) used_map = observe::MakeIntensityMap(all);
  const double noise = observe::EstimateNoise(all), brightest = observe::BrightestRadiance(all);
  const double level = ExposureLevel(brightest);
  if (level != 1.0) {
    observe::Observations copy;
    if (own == nullptr) copy = all;
    return EstimateAtLevel(own != nullptr ? *own : copy, signatures, options, level, refined,
                           calibration, evidence);
  }
  Tell(options.watch, Part::kStart);
  if (StopRequested(options.watch.stop)) return InterruptedError();
  start::Start start = StartOf(all, noise, used_map, options);
  Tell(options.watch, Part::kRefine);
  if (StopRequested(options.watch.stop)) return InterruptedError();
  const double started = stopwatch.Seconds();
  Estimate estimate;
  TakeDecisions(start, estimate);
  const double views_per_distinct = CountViews(signatures, noise, estimate);
  select::Refined result = select::Refine(all, start.scene, noise, views_per_distinct,
                                          options.model, estimate.ladder, options.watch.stop);
  if (StopRequested(options.watch.stop)) return InterruptedError();
  std::optional<uncertainty::CalibrationResponse> response;
  if (calibration) {
    Tell(options.watch, Part::kBudget);
    auto answered = calibration(all, result.solution);
    if (!answered) return Forward(answered);
    response = std::move(*answered);
  }
  FillFromFit(all, result, estimate, response ? &*response : nullptr);
  if (const Status status = CheckLights(estimate, noise, brightest, evidence); !status)
    return Forward(status);
  estimate.initial_rms = estimate.history.empty() ? estimate.rms : estimate.history.front().rms;
  AddNotes(estimate);
  AddCountNote(noise, brightest, estimate);
  estimate.initial_s = started;
  estimate.solve_s = stopwatch.Seconds() - started;
  if (refined) *refined = std::move(result);
  return estimate;
}

}  // namespace

model::Scene Estimate::ToScene() const {
  model::Scene scene;
  scene.reflectance = reflectance;
  for (const LightEstimate& light : lights) scene.lights.push_back(light.light);
  return scene;
}

Result<Estimate> EstimateObservations(const observe::Observations& all,
                                      const std::vector<cv::Mat>& signatures,
                                      const EstimateOptions& options, observe::IntensityMap* map,
                                      select::Refined* refined, const CalibrationAsked& calibration,
                                      const Evidence& evidence) {
  return EstimateWhatIsSeen(all, nullptr, signatures, options, map, refined, calibration, evidence);
}

Result<EstimateOutput> EstimateScene(const model::KeyframeSource& keyframes,
                                     const target::Geometry& geometry, const calib::RayGrid& rays,
                                     const EstimateOptions& options) {
  const Stopwatch stopwatch;
  Tell(options.watch, Part::kObserve);
  auto observed =
      observe::ObserveScene(keyframes, geometry, rays,
                            {options.most_pixels, options.watch.stop, options.watch.on_keyframe});
  if (!observed) return Forward(observed);
  const double built = stopwatch.Seconds();
  EstimateOutput out;
  select::Refined refined;
  CalibrationAsked calibration;
  if (options.calibration)
    calibration = [&](const observe::Observations& all, const solve::Solution& solution) {
      return RespondToCalibration({keyframes.size(), geometry, rays}, all, solution,
                                  *options.calibration, options.watch.stop);
    };
  const std::vector<calib::RigPoses>& poses = keyframes.poses;
  Evidence evidence{observed->counts};
  evidence.copies =
      static_cast<int>(FindCopies(observed->pixels, observed->signatures, poses).size());
  auto estimate = EstimateWhatIsSeen(observed->pixels, &observed->pixels, observed->signatures,
                                     options, &out.map, &refined, calibration, evidence);
  if (!estimate) return Forward(estimate);
  out.estimate = std::move(*estimate);
  out.estimate.initial_s += built;
  if (const Status known = LeaveOutUnknown(observed->pixels, out.estimate); !known)
    return Forward(known);
  ExplainViews(observed->pixels, observed->signatures, poses, refined.solution.scene,
               refined.options.evaluate, options.frame_numbers, out.estimate);
  AddOutliersNote(observed->counts, out.estimate);
  AddThinnedNote(observed->pixels, observed->usable, out.estimate);
  AddFacetsNote(geometry.shape(), out.estimate);
  out.noise = observe::EstimateNoise(observed->pixels);
  out.frame_rms = RmsByKeyframe(observed->pixels, refined.solution.scene, refined.options.evaluate);
  if (options.residuals_of)
    out.residuals =
        ResidualMaps(observed->pixels, refined.solution.scene, refined.options.evaluate,
                     {rays.width(), rays.height()}, options.residuals_of(keyframes.size()));
  return out;
}

Result<EstimateOutput> EstimateScene(const std::vector<model::Keyframe>& keyframes,
                                     const target::Geometry& geometry, const calib::RayGrid& rays,
                                     const EstimateOptions& options) {
  return EstimateScene(model::SourceOf(keyframes), geometry, rays, options);
}

}  // namespace turnlight::estimator
