#include "estimator/photograph_estimate.h"

#include <algorithm>
#include <utility>

#include "estimator/solve/coordinates.h"
#include "estimator/solve/footprints.h"
#include "estimator/solve/photograph_solve.h"
#include "estimator/solve/settled_solve.h"
#include "estimator/start/usual_models.h"

namespace turnlight::estimator {
namespace {

// Mean square of what is left, in the sigmas that are expected of real surfaces: there 0.3 to 3.
// What leaves less is a rendering, and of what leaves more the spots are no highlights.
constexpr double kLeastMisfit = 0.15, kMostMisfit = 3.0;
constexpr double kMostDepartures = 0.7;  // of the diffuse part; more is another surface
constexpr double kClearly = 1.25;        // in mean square

// What is asked for that photographs are not fitted with.
bool IsOpen(const model::ModelChoice& choice) {
  return !choice.coloured.value_or(false) && !choice.changing.value_or(false) &&
         !choice.harmonics.value_or(false) && choice.specular != model::SpecularModel::kNone;
}

// What a scene, in W, leaves of a photograph's pixels.
double MisfitOf(const model::Scene& scene, const observe::Observations& pixels) {
  solve::SolveOptions options = solve::PhotographSolveOptions(scene.lights.size());
  options.max_iterations = 0;
  const solve::Solution there =
      solve::SolveSettled(pixels, solve::ToSolver(scene, pixels), options, 1);
  return start::MisfitOf(pixels, there.equations.cost);
}

}  // namespace

Result<std::optional<Photographed>> LookAtPhotographs(const model::KeyframeSource& keyframes,
                                                      const target::Geometry& geometry,
                                                      const calib::RayGrid& rays,
                                                      const model::ModelChoice& choice,
                                                      const UsualSearch& usual,
                                                      const StopFlag* stop) {
  if (!IsOpen(choice)) return std::optional<Photographed>();
  observe::PhotographOptions options;
  options.stop = stop;
  auto look = observe::TakePhotograph(keyframes, geometry, rays, options);
  if (!look) return Forward(look);
  if (look->spots.empty() || look->pixels.used == 0) return std::optional<Photographed>();
  // What any lights may leave, so that they are taken.
  const double most = usual.fit ? MisfitOf(*usual.fit, look->pixels) / kClearly : kMostMisfit;
  if (!(most > kLeastMisfit)) return std::optional<Photographed>();
  start::PhotographLights lights = start::FindPhotographLights(*look, choice, stop);
  if (StopRequested(stop)) return InterruptedError();
  if (!(lights.misfit > kLeastMisfit && lights.misfit < std::min(most, kMostMisfit)) ||
      lights.strays > 0 || lights.scene.reflectance.shading.norm() > kMostDepartures)
    return std::optional<Photographed>();
  if (usual.sample != nullptr &&
      start::UsualModelsExplain(
          *usual.sample,
          solve::ToSolver(solve::ToWorld(lights.scene, look->pixels), usual.sample->pixels)))
    return std::optional<Photographed>();
  return std::optional(Photographed{std::move(*look), std::move(lights)});
}

select::Refined OnOtherPixels(const select::Refined& refined, const observe::Observations& fitted,
                              const observe::Observations& others) {
  select::Refined out = refined;
  out.solution.scene = solve::ToSolver(solve::ToWorld(refined.solution.scene, fitted), others);
  solve::EvaluateOptions& evaluate = out.options.evaluate;
  evaluate.huber = 0.0;
  evaluate.samples_per_side =
      solve::FootprintSamples(others, out.solution.scene.reflectance, 2, evaluate.aperture);
  evaluate.shadows = solve::CastShadows(others, out.solution.scene);
  out.solution.evaluate = evaluate;
  return out;
}

}  // namespace turnlight::estimator
