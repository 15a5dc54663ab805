#include "estimator/next_view.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "base/angles.h"
#include "base/format.h"
#include "base/messages/messages.h"

namespace turnlight::estimator {
namespace {

// The index of the largest; the first of equals.
std::size_t Worst(const std::vector<double>& sigmas) {
  return static_cast<std::size_t>(std::max_element(sigmas.begin(), sigmas.end()) - sigmas.begin());
}

double Largest(const std::vector<double>& sigmas) { return sigmas[Worst(sigmas)]; }

// The largest item of a light's direction that is not noise.
void FindFloorItem(const Estimate& estimate, NextView& out) {
  double largest = 0.0;
  for (const uncertainty::BudgetItem& item : estimate.budget) {
    const double sigma = item.sigma.lights[out.light].direction;
    if (item.words.item == uncertainty::NoiseWords().item || !(sigma > largest)) continue;
    largest = sigma;
    out.floor_item = item.words.item;
    out.floor_words = item.words.words;
    out.floor_advice = item.words.advice;
  }
}

using Informations = std::vector<Eigen::MatrixXd>;

// The best of the candidates that are left beside what is there already.
NextView::Step BestBeside(const uncertainty::DirectionForecast& forecast,
                          const Informations& informations, const std::vector<std::uint8_t>& taken,
                          const Eigen::MatrixXd& there, std::vector<double>* all) {
  NextView::Step best{informations.size(), HUGE_VAL};
  for (std::size_t i = 0; i < informations.size(); ++i) {
    if (taken[i] != 0) continue;
    const double sigma =
        Largest(uncertainty::ForecastDirections(forecast, there + informations[i]));
    if (all != nullptr) all->push_back(sigma);
    if (sigma < best.sigma) best = {i, sigma};
  }
  return best;
}

void TakeSteps(const uncertainty::DirectionForecast& forecast, const Informations& informations,
               const NextViewOptions& options, NextView& out) {
  if (informations.empty()) return;
  std::vector<std::uint8_t> taken(informations.size(), 0);
  Eigen::MatrixXd there =
      Eigen::MatrixXd::Zero(informations.front().rows(), informations.front().cols());
  double sigma = out.sigma;
  const std::size_t most = std::min(options.wanted ? options.most_views : 1, informations.size());
  while (out.steps.size() < most) {
    const NextView::Step best =
        BestBeside(forecast, informations, taken, there,
                   out.steps.empty() && out.with.empty() ? &out.with : nullptr);
    if (best.candidate == informations.size() || !(best.sigma < (1.0 - kLeastGain) * sigma)) return;
    out.steps.push_back(best);
    sigma = best.sigma;
    taken[best.candidate] = 1;
    there += informations[best.candidate];
    if (options.wanted && sigma <= *options.wanted) return;
  }
}

}  // namespace

std::optional<std::string> WhyNoForecast(const Estimate& estimate) {
  if (!estimate.has_sigmas) return "the method states no sigmas";
  if (estimate.lights.empty()) return "there is no light";
  if (estimate.fit.photograph)
    return "the pictures are photographs of a real surface, whose pixels tell less than noise "
           "says";
  if (estimate.fit.scene.flickers()) return "lights change from frame to frame";
  return std::nullopt;
}

Result<NextView> AdviseNextView(const Estimate& estimate,
                                const std::vector<CandidateView>& candidates,
                                const target::Geometry& geometry, const calib::RayGrid& rays,
                                const Sensor& sensor, const NextViewOptions& options) {
  const uncertainty::DirectionForecast& forecast = estimate.fit.directions;
  NextView out;
  out.wanted = options.wanted;
  const std::vector<double> now = uncertainty::ForecastDirections(forecast);
  out.light = Worst(now);
  out.sigma = now[out.light];
  out.floor = uncertainty::FloorOfDirections(forecast)[out.light];
  FindFloorItem(estimate, out);
  Informations informations;
  for (const CandidateView& view : candidates) {
    if (StopRequested(options.stop)) return InterruptedError();
    informations.push_back(InformationOf(view, estimate.fit, geometry, rays, sensor));
  }
  TakeSteps(forecast, informations, options, out);
  return out;
}

std::string DegreesText(double radians) { return Format("%.2g", RadToDeg(radians)); }

std::string WordsOf(const NextView& advice, const std::vector<CandidateView>& candidates) {
  messages::Values values{{"light", std::to_string(advice.light + 1)},
                          {"sigma", DegreesText(advice.sigma)},
                          {"floor", DegreesText(advice.floor)},
                          {"cause", advice.floor_words},
                          {"advice", advice.floor_advice}};
  if (advice.wanted) values.emplace("wanted", DegreesText(*advice.wanted));
  if (advice.steps.empty())
    return messages::Text(advice.IsMostlyFloor(advice.sigma) ? "next-view/floor" : "next-view/none",
                          values);
  values.emplace("view", candidates[advice.steps.front().candidate].label);
  values.emplace("predicted", DegreesText(advice.steps.front().sigma));
  std::string text = messages::Text("next-view", values);
  if (!advice.wanted || advice.reached()) return text;
  values.emplace("views", Counted(advice.steps.size(), "further view"));
  values.emplace("then", DegreesText(advice.steps.back().sigma));
  if (advice.reachable()) return text + " " + messages::Text("next-view/reachable", values);
  const bool floor = advice.IsMostlyFloor(advice.steps.back().sigma);
  return text + " " +
         messages::Text(floor ? "next-view/unreachable-floor" : "next-view/unreachable", values);
}

Result<ViewAdvice> AdviseOrSayWhy(const Estimate& estimate, std::vector<CandidateView> candidates,
                                  const target::Geometry& geometry, const calib::RayGrid& rays,
                                  const Sensor& sensor, const NextViewOptions& options) {
  ViewAdvice out;
  if (const auto why = WhyNoForecast(estimate)) {
    out.words = messages::Text("next-view/no-forecast", {{"why", *why}});
    return out;
  }
  auto found = AdviseNextView(estimate, candidates, geometry, rays, sensor, options);
  if (!found) return Forward(found);
  out.words = WordsOf(*found, candidates);
  out.candidates = std::move(candidates);
  out.found = std::move(*found);
  return out;
}

}  // namespace turnlight::estimator
