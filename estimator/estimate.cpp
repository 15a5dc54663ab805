#include "estimator/estimate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "base/format.h"
#include "base/messages/messages.h"
#include "base/stopwatch.h"
#include "estimator/calibration_response.h"
#include "estimator/determined.h"
#include "estimator/notes.h"
#include "estimator/observe/radiance_statistics.h"
#include "estimator/observe/views.h"
#include "estimator/report.h"
#include "estimator/residual_maps.h"
#include "estimator/select/ambient_rung.h"
#include "estimator/select/clipped_rung.h"
#include "estimator/select/intensity_rung.h"
#include "estimator/select/photograph_refine.h"
#include "estimator/solve/coordinates.h"
#include "estimator/start/find_start.h"
#include "estimator/start/sample.h"
#include "estimator/start/score.h"
#include "estimator/view_evidence.h"

namespace turnlight::estimator {
namespace {

constexpr double kMuchFromBehind = 0.1;  // of what is seen of the target
constexpr double kRoomForLight = 0.3;    // of white: pictures below it can be exposed longer

// What the pictures show as a whole, of white.
struct Levels {
  double noise = 0.0, brightest = 0.0;
};

// Pictures without a light's share are ambient light alone, unless noise could hide one.
Status CheckLights(const Estimate& estimate, const Levels& levels, const Evidence& evidence) {
  const auto [noise, brightest] = levels;
  if (!estimate.lights.empty()) return {};
  if (!Unexplained(estimate.rms, noise) && !Noisy(noise, brightest)) return {};
  const messages::Values values{
      {"copies", std::to_string(evidence.copies)},
      {"views", Format("%d pictures", estimate.views)},
      {"behind", Format("%.0f", 100.0 * evidence.counts.from_behind)},
      {"rms", Format("%.2g", estimate.rms)},
      {"noise", Format("%.2g", noise)},
      {"share", Format("%.0f", 100.0 * noise / std::max(brightest, 1e-300))},
      {"bright", Format("%.2g", brightest)}};
  if (evidence.copies > 0) return messages::Refuse("no-light/copies", values);
  if (evidence.counts.from_behind > kMuchFromBehind)
    return messages::Refuse("no-light/from-behind", values);
  if (!Noisy(noise, brightest)) return messages::Refuse("no-light/unexplained", values);
  return messages::Refuse(brightest < kRoomForLight ? "no-light/dark" : "no-light/noisy", values);
}

start::Start StartOf(const observe::Observations& all, double noise,
                     const observe::IntensityMap& map, const EstimateOptions& options,
                     const start::Beyond& beyond) {
  if (options.warm_start) return {solve::ToSolver(*options.warm_start, all), {}, {}};
  return start::FindStart(all, noise, map, options.initial, options.model, options.watch.stop,
                          beyond);
}

void Tell(const Watch& watch, Part part) {
  if (watch.on_part) watch.on_part(part);
}

// Gives how many views there are for each that differs from those before.
double CountViews(const observe::Observations& all, const std::vector<cv::Mat>& signatures,
                  double noise, Estimate& out) {
  out.views = static_cast<int>(signatures.size());
  out.distinct_views =
      observe::DistinctViews(signatures, observe::LikeLimit(noise) * all.radiance_unit);
  return out.distinct_views > 0 ? static_cast<double>(out.views) / out.distinct_views : 1.0;
}

// A search for lights, and what was made of it on all pixels.
struct Found {
  model::Scene start;
  select::Refined refined;
  std::vector<model::Rung> ladder;
  std::vector<IterationRecord> history;
  double start_s = 0.0;
  double least_kept = std::numeric_limits<double>::infinity();  // as start::Start's
  Result<std::optional<Photographed>> photograph = std::optional<Photographed>();

  bool of_photograph() const { return photograph && photograph->has_value(); }
  // What it was fitted to, of a photograph not all of its pixels; and the photograph's lights.
  const observe::Observations& Fitted(const observe::Observations& all) const {
    return of_photograph() ? (*photograph)->look.pixels : all;
  }
  const start::PhotographLights* lights() const {
    return of_photograph() ? &(*photograph)->lights : nullptr;
  }
};

// What a photograph's lights are, refined; instead of what was found of the usual models.
void TakePhotograph(const EstimateOptions& options, double views_per_distinct, Found& found) {
  Photographed& photograph = **found.photograph;
  found.ladder = photograph.lights.ladder;
  found.refined =
      select::RefinePhotograph(photograph.look.pixels, photograph.lights.scene, views_per_distinct,
                               options.model, found.ladder, options.watch.stop);
}

// photograph (optional): what the pictures are beyond the usual models; where they are that it is
// what is found, and there is nothing else.
Found Search(const observe::Observations& all, double noise, const observe::IntensityMap& map,
             const EstimateOptions& options, double views_per_distinct,
             const PhotographAsked& photograph = {}) {
  const Stopwatch stopwatch;
  Found out;
  start::Beyond beyond;
  if (photograph)
    beyond = [&](const start::Sample& sample) {
      out.photograph = photograph(options.model, {&sample, nullptr});
      return !out.photograph || out.photograph->has_value();
    };
  start::Start start = StartOf(all, noise, map, options, beyond);
  out.start_s = stopwatch.Seconds();
  Tell(options.watch, Part::kRefine);
  out.ladder = std::move(start.ladder);
  for (const double rms : start.rms_history)
    out.history.push_back({static_cast<int>(out.history.size()), all.radiance_unit * rms});
  out.least_kept = start.least_kept;
  out.start = std::move(start.scene);
  if (StopRequested(options.watch.stop) || !out.photograph) return out;
  if (out.of_photograph()) {
    TakePhotograph(options, views_per_distinct, out);
    return out;
  }
  out.refined = select::Refine(all, out.start, noise, views_per_distinct, options.model, out.ladder,
                               options.watch.stop);
  return out;
}

// By what is left beyond noise.
start::Compared ComparedOf(const observe::Observations& all, double noise,
                           const select::Refined& refined) {
  const double rms = select::Rms(all, refined.solution);
  return {&refined.solution.scene, start::ExcessVariance(rms * rms, noise)};
}

// Lights were looked for as if they were constant, or ambient light even, and what is not may have
// passed for lights: they are looked for once more.
void SearchAgain(const observe::Observations& all, double noise, const observe::IntensityMap& map,
                 EstimateOptions options, double views_per_distinct, Found& found) {
  const model::Scene& scene = found.refined.solution.scene;
  const bool changing = scene.free_factors && !found.start.free_factors;
  const bool uneven = scene.free_harmonics && !found.start.free_harmonics;
  if (options.warm_start || (!changing && !uneven)) return;
  Tell(options.watch, Part::kStart);
  if (changing) options.model.changing = true;
  if (uneven) options.model.harmonics = true;
  Found again = Search(all, noise, map, options, views_per_distinct);
  if (StopRequested(options.watch.stop)) return;
  const bool better = start::BestOf(options.model, {ComparedOf(all, noise, found.refined),
                                                    ComparedOf(all, noise, again.refined)}) == 1;
  model::Rung rung{
      "search-again", better,
      Format("lights looked for once more, with %s: %zu lights, and a residual rms of %.3g instead "
             "of %zu and %.3g; a light costs %.0f times the smaller excess variance of both",
             changing && uneven ? "factors and harmonics"
             : changing         ? "factors"
                                : "harmonics",
             again.refined.solution.scene.lights.size(), select::Rms(all, again.refined.solution),
             scene.lights.size(), select::Rms(all, found.refined.solution), start::kLightPrice)};
  // Why there are factors or harmonics, which were asked for then, the first search says.
  if (better)
    for (const model::Rung& why : found.ladder)
      if ((changing && select::IsOfIntensities(why)) || (uneven && select::IsOfHarmonics(why))) {
        std::erase_if(again.ladder,
                      [&](const model::Rung& asked) { return asked.rung == why.rung; });
        again.ladder.push_back(why);
      }
  if (better) found = std::move(again);
  found.ladder.push_back(std::move(rung));
}

// What no usual model explained is looked at as photographs.
void LookAtHighlights(const observe::Observations& all, double noise,
                      const EstimateOptions& options, double views_per_distinct,
                      const PhotographAsked& photograph, Found& found) {
  if (!Unexplained(select::Rms(all, found.refined.solution), noise)) return;
  const model::Scene usual = solve::ToWorld(found.refined.solution.scene, all);
  found.photograph = photograph(options.model, {nullptr, &usual});
  if (found.of_photograph()) TakePhotograph(options, views_per_distinct, found);
}

// one_view: that no usual model explains it shows early; several may be explained by lights that
// change or a light field.
Found SearchAll(const observe::Observations& all, double noise, const observe::IntensityMap& map,
                const EstimateOptions& options, double views_per_distinct,
                const PhotographAsked& photograph, bool one_view) {
  Found found = Search(all, noise, map, options, views_per_distinct,
                       one_view ? photograph : PhotographAsked());
  if (!StopRequested(options.watch.stop) && !found.of_photograph())
    SearchAgain(all, noise, map, options, views_per_distinct, found);
  if (!one_view && photograph && !StopRequested(options.watch.stop))
    LookAtHighlights(all, noise, options, views_per_distinct, photograph, found);
  return found;
}

void TakeNotes(const observe::Observations& all, const Levels& levels,
               const model::ModelChoice& choice, const Found& found, Estimate& out) {
  AddNotes(out);
  if (out.channels == 1 && choice.coloured.value_or(false)) AddNote("grey/colours", {}, out);
  if (found.lights() != nullptr) {
    AddPhotographNotes(*found.lights(), out);
  } else {
    AddCountNotes(levels.noise, levels.brightest, start::WorthOfRatio(found.least_kept), out);
    AddUnexplainedNote(levels.noise, out);
  }
  if (all.radiance_unit != 1.0)
    AddNote("exposure", {{"level", Format("%.2g", all.radiance_unit)}}, out);
}

}  // namespace

model::Scene Estimate::ToScene() const {
  model::Scene scene;
  scene.reflectance = reflectance;
  for (const LightEstimate& light : lights) scene.lights.push_back(light.light);
  scene.free_colours = channels == 3 && scene.coloured();
  scene.free_factors = scene.flickers();
  scene.free_harmonics = !reflectance.harmonics.isZero(0.0);
  scene.free_shading = !reflectance.shading.isZero(0.0);
  return scene;
}

Result<Estimate> EstimateObservations(observe::Observations& all,
                                      const std::vector<cv::Mat>& signatures,
                                      const EstimateOptions& options, observe::IntensityMap* map,
                                      select::Refined* refined, const CalibrationAsked& calibration,
                                      const Evidence& evidence, const PhotographAsked& photograph) {
  const Stopwatch stopwatch;
  if (const Status status = observe::CheckUsable(all); !status) return Forward(status);
  if (StopRequested(options.watch.stop)) return InterruptedError();
  observe::IntensityMap own_map;
  observe::IntensityMap& used_map = map ? *map : own_map;
  if (map || !options.warm_start) used_map = observe::MakeIntensityMap(all);
  const double noise = observe::EstimateNoise(all);
  Tell(options.watch, Part::kStart);
  Estimate estimate;
  const double views_per_distinct = CountViews(all, signatures, noise, estimate);
  if (StopRequested(options.watch.stop)) return InterruptedError();
  const double before = stopwatch.Seconds();
  Found found =
      SearchAll(all, noise, used_map, options, views_per_distinct, photograph, estimate.views == 1);
  if (!found.photograph) return Forward(found.photograph);
  const Levels levels{all.radiance_unit * noise,
                      all.radiance_unit * observe::BrightestRadiance(all)};
  if (!found.of_photograph()) select::ChooseClipped(noise, all, found.refined, found.ladder);
  if (StopRequested(options.watch.stop)) return InterruptedError();
  estimate.ladder = std::move(found.ladder);
  estimate.history = std::move(found.history);
  estimate.initial_s = before + found.start_s;
  select::Refined& result = found.refined;
  const observe::Observations& fitted = found.Fitted(all);
  std::optional<uncertainty::CalibrationResponse> response;
  if (calibration) {
    Tell(options.watch, Part::kBudget);
    auto answered = calibration(fitted, result.solution);
    if (!answered) return Forward(answered);
    response = std::move(*answered);
  }
  FillFromFit(fitted, result, estimate, response ? &*response : nullptr);
  if (found.of_photograph()) {
    result = OnOtherPixels(result, fitted, all);
    FillResidual(all, result, estimate);
  }
  if (const Status status = CheckLights(estimate, levels, evidence); !status)
    return Forward(status);
  estimate.initial_rms = estimate.history.empty() ? estimate.rms : estimate.history.front().rms;
  TakeNotes(all, levels, options.model, found, estimate);
  estimate.solve_s = stopwatch.Seconds() - estimate.initial_s;
  if (refined) *refined = std::move(result);
  return estimate;
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
  PhotographAsked photograph;
  if (!options.initial && !options.warm_start)
    photograph = [&](const model::ModelChoice& choice, const UsualSearch& usual) {
      return LookAtPhotographs(keyframes, geometry, rays, choice, usual, options.watch.stop);
    };
  const std::vector<calib::RigPoses>& poses = keyframes.poses;
  Evidence evidence{observed->counts};
  evidence.copies =
      static_cast<int>(FindCopies(observed->pixels, observed->signatures, poses).size());
  auto estimate = EstimateObservations(observed->pixels, observed->signatures, options, &out.map,
                                       &refined, calibration, evidence, photograph);
  if (!estimate) return Forward(estimate);
  out.estimate = std::move(*estimate);
  out.estimate.initial_s += built;
  out.estimate.frames = options.frame_numbers;
  if (const Status known = LeaveOutUnknown(observed->pixels, out.estimate); !known)
    return Forward(known);
  ExplainViews(observed->pixels, observed->signatures, poses, refined.solution.scene,
               refined.options.evaluate, options.frame_numbers, out.estimate);
  AddOutliersNote(observed->counts, out.estimate);
  AddThinnedNote(observed->pixels, observed->usable, out.estimate);
  AddFacetsNote(geometry.shape(), out.estimate);
  out.noise = observe::EstimateNoise(observed->pixels) * observed->pixels.radiance_unit;
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
