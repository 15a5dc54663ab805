#include "estimator/photograph_estimate.h"

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

}  // namespace

Result<std::optional<Photographed>> LookAtPhotographs(const model::KeyframeSource& keyframes,
                                                      const target::Geometry& geometry,
                                                      const calib::RayGrid& rays,
                                                      const model::ModelChoice& choice,
                                                      const start::Sample* sample,
                                                      const StopFlag* stop) {
  if (!IsOpen(choice)) return std::optional<Photographed>();
  observe::PhotographOptions options;
  options.stop = stop;
  auto look = observe::TakePhotograph(keyframes, geometry, rays, options);
  if (!look) return Forward(look);
  if (look->spots.empty() || look->pixels.used == 0) return std::optional<Photographed>();
  start::PhotographLights lights = start::FindPhotographLights(*look, choice, stop);
  if (StopRequested(stop)) return InterruptedError();
  if (!(lights.misfit > kLeastMisfit && lights.misfit < kMostMisfit) || lights.strays > 0 ||
      lights.scene.reflectance.shading.norm() > kMostDepartures)
    return std::optional<Photographed>();
  if (sample != nullptr &&
      start::UsualModelsExplain(
          *sample, solve::ToSolver(solve::ToWorld(lights.scene, look->pixels), sample->pixels)))
    return std::optional<Photographed>();
  return std::optional(Photographed{std::move(*look), std::move(lights)});
}

bool LeavesLess(const Photographed& photograph, const select::Refined& usual,
                const observe::Observations& fitted) {
  const observe::Observations& pixels = photograph.look.pixels;
  solve::SolveOptions options = solve::PhotographSolveOptions(usual.solution.scene.lights.size());
  options.max_iterations = 0;
  const solve::Solution there = solve::SolveSettled(
      pixels, solve::ToSolver(solve::ToWorld(usual.solution.scene, fitted), pixels), options, 1);
  return photograph.lights.misfit * kClearly < start::MisfitOf(pixels, there.equations.cost);
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
