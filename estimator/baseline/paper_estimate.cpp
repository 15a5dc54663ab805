#include "estimator/baseline/paper_estimate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "base/format.h"
#include "base/stopwatch.h"
#include "estimator/notes.h"
#include "estimator/observe/intensity_map.h"
#include "estimator/observe/observed_scene.h"
#include "estimator/observe/radiance_statistics.h"
#include "estimator/observe/views.h"
#include "estimator/residual_maps.h"
#include "estimator/solve/coordinates.h"
#include "estimator/view_evidence.h"

namespace turnlight::estimator::baseline {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
const Eigen::Vector3d kUnknownColour = Eigen::Vector3d::Constant(kUnknown);

LightEstimate MakeLight(const model::Light& light, const observe::Observations& observations,
                        const model::Reflectance& reflectance) {
  LightEstimate out;
  out.light = light;
  out.near = true;
  out.direction_sigma = out.inverse_distance_sigma = kUnknown;
  out.distance = 1.0 / light.inverse_distance;
  out.position = light.direction / light.inverse_distance;
  out.direction_at_reference = (*out.position - observations.reference).normalized();
  out.diffuse_product = light.intensity * reflectance.diffuse * reflectance.albedo;
  out.diffuse_product_sigma = kUnknownColour;
  out.specular_product[0] = light.intensity * reflectance.lobes[0].strength;
  out.specular_product_sigma.fill(kUnknown);
  return out;
}

std::string CountText(const PaperSolution& solution) {
  std::size_t cells = 0;
  for (const PaperCluster& cluster : solution.clusters) cells += cluster.cells;
  return std::to_string(solution.clusters.size()) + " clusters of " + std::to_string(cells) +
         " cells of the intensity map that are at or above half of its range";
}

void AddPaperNotes(const PaperOptions& options, Estimate& out) {
  AddNote("distance-brightness-equivalent",
          {{"distance", Format("%.6g", options.ceiling_distance)}}, out);
  AddNote("sigma-none", {}, out);
  if (out.channels == 1) AddNote("grey", {}, out);
  if (out.stopped == solve::Stopped::kIterationLimit) AddNote("not-converged/descent", {}, out);
}

// Lights, reflectance, residuals, decisions and notes.
void FillFromPaper(const observe::Observations& observations, const PaperSolution& solution,
                   const PaperOptions& options, Estimate& out) {
  const model::Scene world = solve::ToWorld(solution.scene, observations);
  out.reflectance = world.reflectance;
  out.reference_point = observations.reference;
  out.channels = observations.channels;
  for (const model::Light& light : world.lights)
    out.lights.push_back(MakeLight(light, observations, world.reflectance));
  std::stable_sort(out.lights.begin(), out.lights.end(),
                   [](const LightEstimate& a, const LightEstimate& b) {
                     return a.light.intensity > b.light.intensity;
                   });
  out.ambient_product = world.reflectance.ambient * world.reflectance.albedo;
  out.ambient_product_sigma = kUnknownColour;
  out.sigma.albedo = kUnknownColour;
  out.sigma.ambient = out.sigma.diffuse = out.sigma.lobes[0].strength = kUnknown;
  out.has_sigmas = false;
  out.condition = kUnknown;
  out.ladder.push_back({"lights", true, CountText(solution)});
  for (const double cost : solution.descent.cost_history)
    out.history.push_back(
        {static_cast<int>(out.history.size()), observations.radiance_unit * std::sqrt(cost)});
  out.initial_rms = out.history.front().rms;
  out.rms = out.history.back().rms;
  out.pixels = observations.used;
  out.iterations = solution.descent.iterations;
  out.stopped =
      solution.descent.converged ? solve::Stopped::kTolerance : solve::Stopped::kIterationLimit;
  AddPaperNotes(options, out);
}

}  // namespace

Result<EstimateOutput> EstimateByPaper(const model::KeyframeSource& keyframes,
                                       const target::Geometry& geometry, const calib::RayGrid& rays,
                                       const PaperOptions& options,
                                       const EstimateOptions& estimate_options) {
  const Stopwatch stopwatch;
  const Watch& watch = estimate_options.watch;
  const auto enter = [&](Part part) {
    if (watch.on_part) watch.on_part(part);
    return !StopRequested(watch.stop);
  };
  if (!enter(Part::kObserve)) return InterruptedError();
  auto observed = observe::ObserveScene(
      keyframes, geometry, rays, {estimate_options.most_pixels, watch.stop, watch.on_keyframe});
  if (!observed) return Forward(observed);
  observe::DropWeights(observed->pixels);  // to the paper all pixels are alike
  const observe::Observations& all = observed->pixels;
  if (!enter(Part::kStart)) return InterruptedError();
  EstimateOutput out;
  out.map = observe::MakeIntensityMap(all);
  const double mapped = stopwatch.Seconds();
  if (!enter(Part::kRefine)) return InterruptedError();
  const auto solution = SolveByPaper(all, out.map, options, watch.stop);
  if (StopRequested(watch.stop)) return InterruptedError();
  if (!solution) return Forward(solution);
  Estimate& estimate = out.estimate;
  FillFromPaper(all, *solution, options, estimate);
  estimate.views = static_cast<int>(keyframes.size());
  estimate.distinct_views = observe::DistinctViews(
      observed->signatures, observe::LikeLimit(observe::EstimateNoise(all)) * all.radiance_unit);
  AddViewsNote(estimate);
  ExplainViews(all, observed->signatures, keyframes.poses, solution->scene, {},
               options.frame_numbers, estimate);
  AddOutliersNote(observed->counts, estimate);
  AddThinnedNote(all, observed->usable, estimate);
  estimate.initial_s = mapped;
  estimate.solve_s = stopwatch.Seconds() - mapped;
  if (estimate_options.residuals_of)
    out.residuals = ResidualMaps(all, solution->scene, {}, {rays.width(), rays.height()},
                                 estimate_options.residuals_of(keyframes.size()));
  return out;
}

}  // namespace turnlight::estimator::baseline
