#include "estimator/select/model_selection.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/format.h"
#include "base/statistics.h"
#include "estimator/select/ambient_rung.h"
#include "estimator/select/intensity_rung.h"
#include "estimator/solve/coordinates.h"
#include "estimator/solve/prediction.h"
#include "estimator/uncertainty/reported.h"
#include "estimator/uncertainty/uncertainty.h"

namespace turnlight::estimator::select {
namespace {

constexpr double kMinSpecularPeak = 0.003;  // of white
constexpr double kMinColour = 0.005;
constexpr double kFirstF0 = 0.5, kKnownF0 = 0.2;
constexpr double kHuberSigmas = 1.0;  // scale of the loss in robust sigmas of the residual

// The median absolute residual as a sigma.
double RobustSigma(const observe::Observations& all, const model::Scene& scene,
                   const solve::EvaluateOptions& options) {
  const auto model = solve::Predict(all, scene, options);
  const solve::PixelMask& usable = options.shadows.usable;
  std::vector<float> residuals;
  residuals.reserve(all.used * static_cast<std::size_t>(all.channels));
  for (int c = 0; c < all.channels; ++c)
    for (std::size_t i = 0; i < all.size(); ++i)
      if (all.pixel[i] != observe::Observations::kNoPixel && (!usable || (*usable)[i] != 0))
        residuals.push_back((all.weight.empty() ? 1.0f : all.weight[i]) *
                            std::abs(model[static_cast<std::size_t>(c)][i] - all.radiance[c][i]));
  return static_cast<double>(Median(residuals)) / kMedianOfNormal;
}

void SolveOnWithSplits(const observe::Observations& observations, Refined& out) {
  SolveOn(observations, out);
  if (StopRequested(out.options.stop)) return;
  out.splits = uncertainty::SplitResiduals(observations, out.solution);
}

// Where the residual is mere noise, squares are the best there is. Where it is more, what is left
// is texture, dirt, or what the model lacks, and large residuals say little about the lights.
void ChooseLoss(const observe::Observations& observations, double noise, Refined& out,
                std::vector<model::Rung>& ladder) {
  const double rms = Rms(observations, out.solution);
  const bool robust = rms > kBeyondNoise * noise;
  ladder.push_back(
      {"robust-loss", robust,
       Format("residual rms %.3g, noise %.3g; from %.1f times the noise on, large residuals "
              "are given less weight",
              rms, noise, kBeyondNoise)});
  if (!robust) return;
  const double sigma = RobustSigma(observations, out.solution.scene, out.options.evaluate);
  out.options.evaluate.huber = std::max(kHuberSigmas * sigma, 1e-6);
  SolveOn(observations, out);
}

void ChooseSpecular(const observe::Observations& observations, Refined& out,
                    std::vector<model::Rung>& ladder) {
  const model::Scene& scene = out.solution.scene;
  if (!scene.reflectance.lobes[0].present()) return;
  const auto order = uncertainty::StrengthOrder(scene, observations);
  // The statistical sigma: a highlight that the model describes badly is a highlight nevertheless.
  const uncertainty::Uncertainties sigmas = uncertainty::EstimateUncertainty(
      out.solution, observations, order, out.views_per_distinct, out.splits);
  const uncertainty::Uncertainty& sigma = sigmas.stat;
  const uncertainty::Reported reported = uncertainty::Report(scene, observations, order);
  // The highlight as it is at the target, wherever W's origin is.
  double strongest = 0.0;
  for (const model::Light& light : scene.lights)
    strongest = std::max(strongest, model::Strength(light));
  const double peak = model::LobePeak(scene.reflectance.lobes[0]) * strongest;
  const double relative =
      sigma.lights.empty() || !(reported.lights.front().specular_product[0] > 0.0)
          ? 1.0
          : sigma.lights.front().specular_product[0] / reported.lights.front().specular_product[0];
  const double own = relative * peak;
  const bool known = std::isfinite(sigma.lobes[0].shape);
  const bool matters = known && peak >= kMinSpecularPeak && peak > kSignificance * own;
  ladder.push_back(
      {"specular", matters,
       Format("the strongest highlight is %.3g of white with sigma %.2g; it counts from "
              "%.3g and 3 sigma",
              peak, own, kMinSpecularPeak) +
           (known ? "" : ", and its width cannot be told")});
  if (matters) return;
  const auto product = [&](const uncertainty::Uncertainty& of) {
    return of.lights.empty() ? own : of.lights.front().specular_product[0];
  };
  out.specular_sigma = product(sigmas.total);
  out.specular_sigma_stat = product(sigmas.stat);
  model::SetLobeModel(out.solution.scene.reflectance, model::SpecularModel::kNone);
  SolveOnWithSplits(observations, out);
}

// Lobes stay as bright straight on.
void SetF0(double f0, model::Reflectance& reflectance) {
  for (model::Lobe& lobe : reflectance.lobes) {
    if (!lobe.present() || !model::FactsOf(lobe.model).physical) continue;
    lobe.strength *= lobe.f0 / f0;
    lobe.f0 = f0;
  }
}

// A second lobe counts if its strength is 3 sigma and its width is known.
void ChooseSecondLobe(const observe::Observations& observations, const model::ModelChoice& choice,
                      Refined& out, std::vector<model::Rung>& ladder) {
  const model::Scene& scene = out.solution.scene;
  const model::Lobe& second = scene.reflectance.lobes[1];
  if (!second.present() || choice.lobes) return;
  const auto order = uncertainty::StrengthOrder(scene, observations);
  const uncertainty::LobeSigma sigma =
      uncertainty::EstimateUncertainty(out.solution, observations, order, out.views_per_distinct,
                                       out.splits)
          .total.lobes[1];
  const double strength =
      uncertainty::Report(scene, observations, order).reflectance.lobes[1].strength;
  const bool told = std::isfinite(sigma.shape) && strength > kSignificance * sigma.strength;
  ladder.push_back({"second-lobe-known", told,
                    Format("the second lobe's strength is %.3g with sigma %.2g; it counts from 3 "
                           "sigma",
                           strength, sigma.strength)});
  if (told) return;
  out.solution.scene.reflectance.lobes[1] = model::Lobe{};
  SolveOnWithSplits(observations, out);
}

// Of a physical lobe F is 1 everywhere unless the views tell F0 from that.
void ChooseFresnel(const observe::Observations& observations, Refined& out,
                   std::vector<model::Rung>& ladder) {
  const auto& lobes = out.solution.scene.reflectance.lobes;
  if (!lobes[0].present() || !model::FactsOf(lobes[0].model).physical) return;
  const Refined held = out;
  // A start at the bound would be held there; one that the user gave stays.
  if (!(lobes[0].f0 < 1.0)) SetF0(kFirstF0, out.solution.scene.reflectance);
  out.options.free_f0 = true;
  SolveOnWithSplits(observations, out);
  if (StopRequested(out.options.stop)) return;
  const auto order = uncertainty::StrengthOrder(out.solution.scene, observations);
  const double sigma = uncertainty::EstimateUncertainty(out.solution, observations, order,
                                                        out.views_per_distinct, out.splits)
                           .total.lobes[0]
                           .f0;
  const double f0 = out.solution.scene.reflectance.lobes[0].f0;
  const bool told = std::isfinite(sigma) && sigma < kKnownF0 && 1.0 - f0 > kSignificance * sigma;
  ladder.push_back({"fresnel", told,
                    Format("F0 is %.3g with sigma %.2g; it counts if it is below 1 by 3 sigma and "
                           "sigma is below %.2g",
                           f0, sigma, kKnownF0)});
  if (told) return;
  out = held;
  if (!(lobes[0].f0 < 1.0)) return;
  SetF0(1.0, out.solution.scene.reflectance);
  SolveOnWithSplits(observations, out);
}

// Every light is white, ambient light and highlights too.
void DropColours(Refined& out) {
  model::Scene& scene = out.solution.scene;
  scene.free_colours = false;
  for (model::Light& light : scene.lights) light.color.setOnes();
  scene.reflectance.ambient_colour.setOnes();
  scene.reflectance.specular_colour.setOnes();
  out.options.white.clear();
}

// Ambient light alone: its colour is the albedo's.
void DropColoursOfNoLight(const observe::Observations& observations, Refined& out) {
  model::Reflectance& r = out.solution.scene.reflectance;
  r.albedo = r.albedo.cwiseProduct(r.ambient_colour);
  DropColours(out);
  SolveOnWithSplits(observations, out);
}

// What `--model color=` asked for, and whether it could be had.
void TellColoursAskedFor(const model::Scene& scene, bool grey, bool asked,
                         std::vector<model::Rung>& ladder) {
  const char* why = "as asked for";
  if (asked && grey) why = "asked for, but the pictures have one channel, which shows no colour";
  if (asked && !grey && scene.lights.empty()) why = "asked for, but there is no light";
  ladder.push_back({"colours", scene.free_colours, why});
}

// Whether a colour is off white, by more than its sigma allows.
bool TellColour(const std::string& whose, const Eigen::Vector3d& colour,
                const Eigen::Vector3d& sigma, std::vector<model::Rung>& ladder) {
  double most = 0.0, sigmas = 0.0;
  for (int c = 0; c < 3; ++c) {
    const double off = 1.0 - colour[c];
    most = std::max(most, off);
    if (off > 0.0 && std::isfinite(sigma[c]))
      sigmas = std::max(sigmas, off / std::max(sigma[c], 1e-12));
  }
  const bool coloured = most > kMinColour && sigmas > kSignificance;
  ladder.push_back({"colour of " + whose, coloured,
                    Format("a channel is %.3g below the largest, %.3g sigma; it counts from %.2g "
                           "and 3 sigma",
                           most, sigmas, kMinColour)});
  return coloured;
}

// A light is coloured if a channel of its colour is off white, or off the strongest light's, by
// more than its sigma allows; none is: all are white.
void ChooseColours(const observe::Observations& observations, const model::ModelChoice& choice,
                   Refined& out, std::vector<model::Rung>& ladder) {
  model::Scene& scene = out.solution.scene;
  if (scene.free_colours && scene.lights.empty()) DropColoursOfNoLight(observations, out);
  if (choice.coloured)
    TellColoursAskedFor(scene, observations.channels == 1, *choice.coloured, ladder);
  if (!scene.free_colours || choice.coloured) return;
  // Judged beside the strongest light, whichever is to be called white.
  const std::size_t white_light = std::exchange(scene.white_light, 0);
  const auto order = uncertainty::StrengthOrder(scene, observations);
  const uncertainty::Uncertainty sigma =
      uncertainty::EstimateUncertainty(out.solution, observations, order, out.views_per_distinct,
                                       out.splits)
          .total;
  const uncertainty::Reported reported = uncertainty::Report(scene, observations, order);
  scene.white_light = white_light;
  out.options.white.assign(order.size(), true);
  bool any = false;
  for (std::size_t i = 1; i < order.size(); ++i) {
    const bool coloured =
        TellColour("light " + std::to_string(order[i] + 1), reported.lights[i].light.color,
                   sigma.lights[i].colour, ladder);
    any = any || coloured;
    out.options.white[order[i]] = !coloured;
  }
  // Under one light that is not white, the highlight has its colour, and the albedo the rest.
  const model::Reflectance& r = reported.reflectance;
  any |= r.lobes[0].present() &&
         TellColour("the highlights", r.specular_colour, sigma.specular_colour, ladder);
  any |= r.ambient > 0.0 &&
         TellColour("ambient light", r.ambient_colour, sigma.ambient_colour, ladder);
  // Where anything has a colour these two are fitted, too.
  const Eigen::Vector3d gauge = scene.lights[order[0]].color;
  for (std::size_t l = 0; l < scene.lights.size(); ++l)
    if (out.options.white[l]) scene.lights[l].color = gauge;
  if (!any) DropColours(out);
  SolveOnWithSplits(observations, out);
}

// A light is near if its inverse distance about the reference, in 1/R, says so.
void ChooseDistances(const observe::Observations& observations, const model::ModelChoice& choice,
                     Refined& out, std::vector<model::Rung>& ladder) {
  const std::size_t lights = out.solution.scene.lights.size();
  std::vector<std::size_t> own_order(lights);
  for (std::size_t l = 0; l < lights; ++l) own_order[l] = l;
  const uncertainty::Uncertainties sigmas = uncertainty::EstimateUncertainty(
      out.solution, observations, own_order, out.views_per_distinct, out.splits);
  const uncertainty::Uncertainty& sigma = sigmas.total;
  const uncertainty::Reported reported =
      uncertainty::Report(out.solution.scene, observations, own_order);
  out.near.assign(lights, false);
  bool refit = false;
  for (std::size_t l = 0; l < lights; ++l) {
    // About W's origin, for the reader; the decision is about the target, wherever the origin is.
    out.inverse_distance.push_back(reported.lights[l].light.inverse_distance);
    out.inverse_distance_sigma.push_back(sigma.lights[l].inverse_distance);
    out.inverse_distance_sigma_stat.push_back(sigmas.stat.lights[l].inverse_distance);
    const double rho = out.solution.scene.lights[l].inverse_distance;
    const double own = sigma.lights[l].inverse_distance_at_reference;
    // Asked for or not: a light that the fit put at infinity has no distance.
    out.near[l] = choice.near ? *choice.near && rho > 0.0
                              : rho >= kMinInverseDistance && rho > kSignificance * own;
    if (!out.near[l] && rho > 0.0) refit = true;
    ladder.push_back(
        {"near light " + std::to_string(l + 1), out.near[l],
         Format("radius over distance is %.3g with sigma %.2g; ", rho, own) +
             (choice.near ? "as asked for"
                          : Format("it counts from %.3g and 3 sigma", kMinInverseDistance))});
  }
  if (!refit) return;
  out.options.fixed_distance.assign(lights, false);
  for (std::size_t l = 0; l < lights; ++l)
    if (!out.near[l]) {
      out.options.fixed_distance[l] = true;
      out.solution.scene.lights[l].inverse_distance = 0.0;
    }
  SolveOnWithSplits(observations, out);
}

model::Scene AsChosen(model::Scene scene, const observe::Observations& observations,
                      const model::ModelChoice& choice) {
  scene.distance = solve::ToSolver(choice.distance, observations);
  if (choice.changing == false) scene = model::WithoutFactors(std::move(scene));
  if (choice.changing == true) scene.free_factors = true;
  scene.white_light = static_cast<std::size_t>(choice.white.value_or(1) - 1);
  if (choice.harmonics == false) scene.reflectance.harmonics.setZero();
  scene.free_harmonics = choice.harmonics.value_or(scene.free_harmonics);
  return scene;
}

}  // namespace

Refined Refine(const observe::Observations& observations, const model::Scene& start, double noise,
               double views_per_distinct, const model::ModelChoice& choice,
               std::vector<model::Rung>& ladder, const StopFlag* stop) {
  Refined out;
  out.options.stop = stop;
  out.views_per_distinct = views_per_distinct;
  out.solution.scene = AsChosen(start, observations, choice);
  SolveOn(observations, out);
  if (StopRequested(stop)) return out;
  ChooseIntensities(observations, noise, choice, out, ladder);
  if (StopRequested(stop)) return out;
  ChooseLoss(observations, noise, out, ladder);
  if (StopRequested(stop)) return out;
  out.splits = uncertainty::SplitResiduals(observations, out.solution);
  if (StopRequested(stop)) return out;
  if (choice.specular)
    ladder.push_back({"specular", *choice.specular != model::SpecularModel::kNone, "as asked for"});
  else
    ChooseSpecular(observations, out, ladder);
  if (StopRequested(stop)) return out;
  ChooseSecondLobe(observations, choice, out, ladder);
  if (StopRequested(stop)) return out;
  ChooseColours(observations, choice, out, ladder);
  if (StopRequested(stop)) return out;
  ChooseFresnel(observations, out, ladder);
  if (StopRequested(stop)) return out;
  ChooseHarmonics(observations, noise, choice, out, ladder);
  if (StopRequested(stop)) return out;
  ChooseDistances(observations, choice, out, ladder);
  return out;
}

}  // namespace turnlight::estimator::select
