#include "estimator/select/photograph_refine.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "base/format.h"
#include "estimator/solve/photograph_solve.h"
#include "estimator/uncertainty/reported.h"
#include "estimator/uncertainty/uncertainty.h"

namespace turnlight::estimator::select {
namespace {

// The statistical sigma knows nothing of departures of higher orders than are fitted, nor of those
// that each light has for itself.
constexpr double kMoreDepartures = 4.0;
constexpr double kLeastPeak = 1e-4;  // of the brightest highlight: a lobe that is there

void SolveAs(const observe::Observations& pixels, Refined& out) {
  SolveOn(pixels, out);
  out.splits.photograph = uncertainty::ErrorsOfHighlights(pixels, out.solution.scene);
}

bool DropLobes(model::Reflectance& r) {
  if (!r.lobes[1].present()) return false;
  const double first = model::LobePeak(r.lobes[0]), second = model::LobePeak(r.lobes[1]);
  if (std::min(first, second) >= kLeastPeak * std::max(first, second)) return false;
  if (first < second) r.lobes[0] = r.lobes[1];
  r.lobes[1] = model::Lobe{};
  return true;
}

std::vector<std::size_t> OwnOrder(std::size_t lights) {
  std::vector<std::size_t> order(lights);
  for (std::size_t l = 0; l < lights; ++l) order[l] = l;
  return order;
}

// Of the fit with free distances.
void ChooseNear(const observe::Observations& pixels, const Refined& free,
                const model::ModelChoice& choice, Refined& out, std::vector<model::Rung>& ladder) {
  const std::size_t lights = free.solution.scene.lights.size();
  const auto order = OwnOrder(lights);
  const uncertainty::Uncertainties sigmas = uncertainty::EstimateUncertainty(
      free.solution, pixels, order, free.views_per_distinct, free.splits);
  const uncertainty::Reported reported = uncertainty::Report(free.solution.scene, pixels, order);
  out.near.assign(lights, false);
  for (std::size_t l = 0; l < lights; ++l) {
    const uncertainty::LightSigma& sigma = sigmas.total.lights[l];
    out.inverse_distance.push_back(reported.lights[l].light.inverse_distance);
    out.inverse_distance_sigma.push_back(kMoreDepartures * sigma.inverse_distance);
    out.inverse_distance_sigma_stat.push_back(sigmas.stat.lights[l].inverse_distance);
    const double rho = free.solution.scene.lights[l].inverse_distance;
    const double own = kMoreDepartures * sigma.inverse_distance_at_reference;
    out.near[l] = choice.near ? *choice.near && rho > 0.0
                              : rho >= kMinInverseDistance && rho > kSignificance * own;
    ladder.push_back(
        {"near light " + std::to_string(l + 1), out.near[l],
         Format("radius over distance is %.3g with sigma %.2g, the diffuse part's departures being "
                "free; ",
                rho, own) +
             (choice.near ? "as asked for"
                          : Format("it counts from %.3g and 3 sigma", kMinInverseDistance))});
  }
}

}  // namespace

Refined RefinePhotograph(const observe::Observations& pixels, const model::Scene& start,
                         double views_per_distinct, const model::ModelChoice& choice,
                         std::vector<model::Rung>& ladder, const StopFlag* stop) {
  Refined out;
  const std::size_t lights = start.lights.size();
  out.options = solve::PhotographSolveOptions(lights);
  out.options.stop = stop;
  out.views_per_distinct = views_per_distinct;
  out.solution.scene = start;
  SolveAs(pixels, out);
  if (DropLobes(out.solution.scene.reflectance)) SolveAs(pixels, out);
  if (StopRequested(stop)) return out;
  Refined free = out;
  free.options.fixed_distance.clear();
  SolveAs(pixels, free);
  if (StopRequested(stop)) return out;
  ChooseNear(pixels, free, choice, out, ladder);
  bool changed = false;
  for (std::size_t l = 0; l < lights; ++l) {
    model::Light& light = out.solution.scene.lights[l];
    changed |= out.near[l] || light.inverse_distance > 0.0;
    out.options.fixed_distance[l] = !out.near[l];
    if (out.near[l])
      light = free.solution.scene.lights[l];
    else
      light.inverse_distance = 0.0;
  }
  if (changed) SolveAs(pixels, out);
  return out;
}

}  // namespace turnlight::estimator::select
