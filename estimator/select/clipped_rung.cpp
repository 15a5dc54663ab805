#include "estimator/select/clipped_rung.h"

#include <algorithm>
#include <cmath>

#include "base/format.h"
#include "base/statistics.h"
#include "estimator/solve/footprints.h"
#include "estimator/solve/prediction.h"
#include "estimator/solve/shadows.h"

namespace turnlight::estimator::select {
namespace {

// The robust sigma of what is left beside pixels at white over that of all pixels, or over noise,
// up to which they are as the others.
constexpr double kAsOthers = 3.0;

struct Beside {
  std::size_t pixels = 0, at_white = 0;  // beside those
  double sigma = 0.0;                    // of the residual beside them, from its median
};

Beside LeftBeside(const observe::Observations& all, const Refined& fit) {
  const model::Scene& scene = fit.solution.scene;
  solve::EvaluateOptions options = fit.options.evaluate;
  options.samples_per_side = solve::FootprintSamples(all, scene.reflectance, 2, options.aperture);
  options.shadows = solve::CastShadows(all, scene);
  const auto model = solve::Predict(all, scene, options);
  std::vector<float> left;
  Beside out;
  for (const observe::HeldBack& held : all.held_back) {
    if (held.at_white != observe::kBesideWhite) {
      ++out.at_white;
      continue;
    }
    if (options.shadows.usable && (*options.shadows.usable)[held.at] == 0) continue;
    ++out.pixels;
    for (std::size_t c = 0; c < model.size(); ++c)
      left.push_back(static_cast<float>(all.WeightOf(held.at)) *
                     std::abs(model[c][held.at] - all.radiance[c][held.at]));
  }
  if (!left.empty()) out.sigma = static_cast<double>(Median(left)) / kMedianOfNormal;
  return out;
}

}  // namespace

void ChooseClipped(double noise, observe::Observations& all, Refined& out,
                   std::vector<model::Rung>& ladder) {
  if (all.held_back.empty()) return;
  const double others = std::max(Rms(all, out.solution), noise);
  observe::TakeHeldBack(all);
  const Beside beside = LeftBeside(all, out);
  const bool taken = beside.pixels > 0 && beside.sigma <= kAsOthers * others;
  ladder.push_back(
      {"clipped", taken,
       Format(
           "%zu pixels at white and %zu beside them, of which %.3g is left; they are taken up to "
           "%.0f times the %.3g of all others, those at white as this or more",
           beside.at_white, beside.pixels, beside.sigma, kAsOthers, others)});
  if (!taken) {
    observe::HoldBack(all);
    return;
  }
  out.solution.evaluate.shadows = {};
  SolveOn(all, out);
  if (!StopRequested(out.options.stop)) out.splits = uncertainty::SplitResiduals(all, out.solution);
}

}  // namespace turnlight::estimator::select
