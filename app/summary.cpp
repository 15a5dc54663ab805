#include "app/summary.h"

#include <algorithm>
#include <cmath>

#include "base/angles.h"
#include "base/format.h"
#include "base/printable.h"
#include "estimator/determined.h"
#include "estimator/results/result_json.h"

namespace turnlight::app {
namespace {

using estimator::Estimate;
using estimator::LightEstimate;

constexpr const char* kPlusMinus = " \u00b1 ";

// Two columns: what, and the values.
std::string Row(const std::string& what, const std::string& values) {
  return Format("  %-12s", what.c_str()) + values + "\n";
}

std::string ModelText(const Estimate& estimate) {
  const auto near = std::count_if(estimate.lights.begin(), estimate.lights.end(),
                                  [](const LightEstimate& light) { return light.near; });
  const auto distant = static_cast<std::ptrdiff_t>(estimate.lights.size()) - near;
  std::string text = Counted(estimate.lights.size(), "light");
  if (near > 0 && distant > 0)
    text += " (" + std::to_string(near) + " near, " + std::to_string(distant) + " distant)";
  else
    text += near > 0 ? " (near)" : " (distant)";
  const estimator::model::Reflectance& r = estimate.reflectance;
  text += std::string(", ") + FactsOf(r.diffuse_model).name;
  if (!r.lobes[0].present()) return text + ", no highlight";
  for (const estimator::model::Lobe& lobe : r.lobes)
    if (lobe.present()) text += std::string(" + ") + FactsOf(lobe.model).name;
  return text;
}

// The value of a key of result.json, or that its sigma allows anything.
std::string MeasureOf(const Estimate& estimate, const std::string& key, double value,
                      double sigma) {
  if (!estimator::IsUndetermined(estimate, key)) return Measure(value, sigma);
  return std::isfinite(sigma) && sigma > 0.0 ? "not known (sigma " + Format("%.2g", sigma) + ")"
                                             : "not known";
}

std::string DistanceText(const Estimate& estimate, std::size_t i, const std::string& unit) {
  const LightEstimate& light = estimate.lights[i];
  if (estimator::IsUndetermined(estimate, "lights/" + std::to_string(i) + "/distance"))
    return "near, distance not known";
  if (light.near && light.distance)
    return "distance " + Measure(*light.distance, light.distance_sigma.value_or(0.0)) + " " + unit;
  if (light.distance_min)
    return "distant (beyond " + Format("%.3g", *light.distance_min) + " " + unit + ", 95 %)";
  return "distance unknown";
}

// Of the largest channel; nothing of a white light.
std::string ColourText(const LightEstimate& light) {
  if (light.light.color == Eigen::Vector3d::Ones()) return "";
  std::string text = "   colour";
  for (int c = 0; c < 3; ++c)
    text += (c > 0 ? ",  " : " ") + Measure(light.light.color[c], light.colour_sigma[c]);
  return text;
}

// Nothing of a constant light.
std::string ChangeText(const LightEstimate& light) {
  const std::vector<double>& factors = light.light.factors;
  double low = 1.0, high = 1.0;
  for (std::size_t k = 0; k < factors.size(); ++k) {
    // Of a frame that does not see the light nothing is known.
    if (k < light.factor_sigma.size() && !std::isfinite(light.factor_sigma[k])) continue;
    low = std::min(low, factors[k]);
    high = std::max(high, factors[k]);
  }
  return factors.empty() ? "" : Format("   changes from frame to frame, %.3g to %.3g", low, high);
}

std::string LightText(const Estimate& estimate, std::size_t i, const std::string& unit) {
  const LightEstimate& light = estimate.lights[i];
  const Eigen::Vector3d& u = light.light.direction;
  const bool has_sigma = std::isfinite(light.direction_sigma);
  return Format("(%+.4f, %+.4f, %+.4f)", u.x(), u.y(), u.z()) +
         (has_sigma ? kPlusMinus + Format("%.2g\u00b0", RadToDeg(light.direction_sigma)) : "") +
         "   " + DistanceText(estimate, i, unit) + "   intensity " +
         MeasureOf(estimate, "lights/" + std::to_string(i) + "/intensity", light.light.intensity,
                   light.intensity_sigma.value_or(0.0)) +
         ColourText(light) + ChangeText(light);
}

std::string LobesText(const Estimate& estimate) {
  std::string text;
  for (std::size_t k = 0; k < estimator::model::kMostLobes; ++k) {
    const estimator::model::Lobe& lobe = estimate.reflectance.lobes[k];
    if (!lobe.present()) continue;
    const estimator::model::reflectance::LobeFacts& facts = FactsOf(lobe.model);
    const estimator::ReflectanceSigma::OfLobe& sigma = estimate.sigma.lobes[k];
    // Of the first lobe's shape the keys of result.json say whether it is known.
    const std::string key = facts.physical ? "reflectance/lobes/0/alpha" : "reflectance/shininess";
    const bool known = k > 0 || !estimator::IsUndetermined(estimate, key);
    std::string values =
        k > 0 ? Measure(lobe.strength, sigma.strength)
              : MeasureOf(estimate, "reflectance/specular", lobe.strength, sigma.strength);
    values += std::string(",  ") + facts.shape_key + " " +
              (known ? Measure(lobe.shape, sigma.shape.value_or(0.0))
                     : MeasureOf(estimate, key, lobe.shape, sigma.shape.value_or(0.0)));
    if (sigma.f0) values += ",  F0 " + Measure(lobe.f0, *sigma.f0);
    if (known)
      values += Format(" (highlight %.3g\u00b0 wide)", estimator::results::LobeWidthDeg(lobe));
    text += Row("specular", values);
  }
  return text;
}

std::string ReflectanceText(const Estimate& estimate) {
  const estimator::model::Reflectance& r = estimate.reflectance;
  const auto of = [&](const std::string& key, double value, double sigma) {
    return MeasureOf(estimate, "reflectance/" + key, value, sigma);
  };
  std::string albedo;
  for (int c = 0; c < 3; ++c)
    albedo += (c > 0 ? ",  " : "") +
              of("albedo/" + std::to_string(c), r.albedo[c], estimate.sigma.albedo[c]);
  std::string diffuse = of("diffuse", r.diffuse, estimate.sigma.diffuse);
  if (r.diffuse_model == estimator::model::DiffuseModel::kOrenNayar)
    diffuse += ",  roughness " +
               of("roughness_deg", RadToDeg(r.roughness),
                  RadToDeg(estimate.sigma.roughness.value_or(0.0))) +
               "\u00b0";
  std::string ambient = of("ambient", r.ambient, estimate.sigma.ambient);
  if (const double uneven = r.harmonics.norm(); uneven > 0.0)
    ambient += Format(" from all sides, and %.2g rms that depends on the side", uneven);
  const std::string text =
      Row("albedo", albedo) + Row("ambient", ambient) + Row("diffuse", diffuse);
  if (!r.lobes[0].present()) return text + Row("specular", "none");
  return text + LobesText(estimate);
}

// "direction of light 1: 0.12 deg, of that 0.1 deg from the pose of the camera (camera-pose): ...".
// Nothing where nothing is known of the sigma.
std::string BudgetLine(const Estimate& estimate, std::size_t light) {
  const double total = RadToDeg(estimate.lights[light].direction_sigma);
  const estimator::uncertainty::BudgetItem* largest = nullptr;
  const auto of = [light](const estimator::uncertainty::BudgetItem& item) {
    return RadToDeg(item.sigma.lights[light].direction);
  };
  for (const auto& item : estimate.budget)
    if (largest == nullptr || of(item) > of(*largest)) largest = &item;
  if (largest == nullptr || !std::isfinite(total) || !(total > 0.0)) return "";
  return "  direction of light " + std::to_string(light + 1) +
         Format(": %.2g\u00b0, of that %.2g\u00b0 from ", total, of(*largest)) +
         largest->words.words + "; " + largest->words.advice + "\n";
}

std::string BudgetText(const Estimate& estimate) {
  std::string text;
  for (std::size_t i = 0; i < estimate.lights.size(); ++i) text += BudgetLine(estimate, i);
  return text.empty() ? text : "\nerror budget, the largest items\n" + text;
}

std::string LadderText(const Estimate& estimate) {
  std::string text;
  for (const estimator::model::Rung& rung : estimate.ladder)
    text += std::string("  ") + (rung.accepted ? "yes  " : "no   ") + rung.rung +
            (rung.why.empty() ? "" : ": " + rung.why) + "\n";
  return text.empty() ? text : "\ndecisions\n" + text;
}

std::string NotesText(const Estimate& estimate) {
  std::string text;
  for (const estimator::Note& note : estimate.notes)
    text += "  " + note.code + ": " + Printable(note.text) + "\n";
  for (const std::string& weak : estimate.weak) text += "  weak: " + weak + "\n";
  return text.empty() ? text : "\nnotes\n" + text;
}

}  // namespace

std::string Measure(double value, double sigma) {
  if (!(sigma > 0.0) || !std::isfinite(sigma) || !std::isfinite(value))
    return Format("%.4g", value);
  const int digits = std::clamp(1 - static_cast<int>(std::floor(std::log10(sigma))), 0, 12);
  return Format("%.*f", digits, value) + kPlusMinus + Format("%.*f", digits, sigma);
}

std::string Summary(const Estimate& estimate, const std::string& session_name,
                    const std::string& length_unit) {
  std::string text = Printable(session_name) + ": " +
                     Counted(static_cast<std::size_t>(estimate.views), "view") + ", " +
                     Counted(estimate.pixels, "pixel") + "\n\n";
  text += Row("model", ModelText(estimate));
  for (std::size_t i = 0; i < estimate.lights.size(); ++i)
    text += Row("light " + std::to_string(i + 1), LightText(estimate, i, length_unit));
  text += ReflectanceText(estimate);
  text += Row("residual", Format("%.3g rms of white, from %.3g at the start; %d iterations, %s",
                                 estimate.rms, estimate.initial_rms, estimate.iterations,
                                 estimator::results::WordOf(estimate.stopped).c_str()));
  return text + BudgetText(estimate) + LadderText(estimate) + NotesText(estimate);
}

}  // namespace turnlight::app
