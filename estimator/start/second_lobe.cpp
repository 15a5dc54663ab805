#include "estimator/start/second_lobe.h"

#include <algorithm>
#include <utility>

#include "base/format.h"
#include "estimator/start/eliminate_lights.h"
#include "estimator/start/score.h"

namespace turnlight::estimator::start {
namespace {

constexpr double kWidths = 4.0;      // of the first lobe's width, or one over it
constexpr double kFirstPeak = 0.25;  // of the first lobe's
constexpr char kRung[] = "second-lobe";

// widths: how many times as broad the second lobe is.
Candidate WithSecond(Candidate candidate, double widths) {
  model::Reflectance& r = candidate.scene.reflectance;
  r.lobes[1] = model::OfWidth(r.lobes[0], widths);
  r.lobes[1].strength *= kFirstPeak;
  return candidate;
}

void PutSharperFirst(Candidate& candidate) {
  auto& lobes = candidate.scene.reflectance.lobes;
  if (model::LobeHalfWidth(lobes[1]) < model::LobeHalfWidth(lobes[0]))
    std::swap(lobes[0], lobes[1]);
}

}  // namespace

Candidate ChooseSecondLobe(const Sample& sample, const Candidate& candidate,
                           std::vector<model::Rung>& ladder) {
  const auto& lobes = candidate.scene.reflectance.lobes;
  const auto& asked = sample.choice.lobes;
  const bool open = asked ? *asked == 2 : !sample.choice.specular;
  if (asked == 1) ladder.push_back({kRung, false, "as asked for"});
  if (open && asked && !lobes[0].present())
    ladder.push_back({kRung, false, "asked for, but there is no highlight"});
  if (!open || !lobes[0].present() || lobes[1].present()) return candidate;
  if (!asked && NothingLeft(candidate.excess, sample)) return candidate;
  Candidate best;
  for (const double widths : {kWidths, 1.0 / kWidths}) {
    Candidate fitted = Refit(sample, WithSecond(candidate, widths), 40, sample.noise, kToKeep);
    if (!best.scene.reflectance.lobes[1].present() || fitted.excess < best.excess)
      best = std::move(fitted);
  }
  PutSharperFirst(best);
  bool accepted = asked || BestOf(sample.choice, {{&candidate.scene, candidate.excess},
                                                  {&best.scene, best.excess}}) == 1;
  if (accepted && !asked) {
    best = Eliminate(sample, best);
    accepted = best.scene.lights.size() <= candidate.scene.lights.size();
  }
  ladder.push_back({kRung, accepted,
                    asked ? "as asked for"
                          : Format("excess variance %.3g with one lobe, %.3g with a sharp and a "
                                   "broad one; it counts from a ratio of %.1f",
                                   candidate.excess, best.excess, RatioFor(kSecondLobePrice))});
  return accepted ? best : candidate;
}

}  // namespace turnlight::estimator::start
