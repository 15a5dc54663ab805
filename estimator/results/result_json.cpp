#include "estimator/results/result_json.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "base/angles.h"
#include "base/messages/messages.h"
#include "estimator/results/correlation_json.h"
#include "estimator/results/next_view_json.h"
#include "estimator/results/null_notes.h"
#include "estimator/results/scene_json.h"

namespace turnlight::estimator::results {
namespace {

using nlohmann::ordered_json;
namespace reflectance = model::reflectance;

ordered_json ToJson(double value) {
  return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
}

ordered_json ToJson(const std::optional<double>& value) {
  return value ? ToJson(*value) : ordered_json(nullptr);
}

ordered_json ToJson(const Eigen::Vector3d& v) {
  return ordered_json::array({ToJson(v.x()), ToJson(v.y()), ToJson(v.z())});
}

ordered_json ToJson(const Eigen::Matrix3d& m) {
  ordered_json rows = ordered_json::array();
  for (int row = 0; row < 3; ++row) rows.push_back(ToJson(Eigen::Vector3d(m.row(row))));
  return rows;
}

ordered_json ToJson(const std::vector<double>& values) {
  ordered_json list = ordered_json::array();
  for (const double value : values) list.push_back(ToJson(value));
  return list;
}

ordered_json ToJson(const Eigen::Matrix<double, model::kHarmonics, 1>& values) {
  return ToJson(std::vector<double>(values.begin(), values.end()));
}

template <typename T>
ordered_json ToJson(const std::optional<T>& value) {
  return value ? ToJson(*value) : ordered_json(nullptr);
}

bool HasLobe(const Estimate& estimate) { return estimate.reflectance.lobes[0].present(); }

// Whether the first lobe's shape is what `shininess` says.
bool HasShininess(const Estimate& estimate) {
  return HasLobe(estimate) && !model::FactsOf(estimate.reflectance.lobes[0].model).physical;
}

bool IsOrenNayar(const Estimate& estimate) {
  return estimate.reflectance.diffuse_model == model::DiffuseModel::kOrenNayar;
}

bool HasAmbientColour(const Estimate& estimate) {
  return estimate.reflectance.ambient_colour != Eigen::Vector3d::Ones();
}
bool HasSpecularColour(const Estimate& estimate) {
  return HasLobe(estimate) && estimate.reflectance.specular_colour != Eigen::Vector3d::Ones();
}

bool IsZero(double value) { return value == 0.0; }
bool IsZero(const Eigen::Vector3d& value) { return value.isZero(0.0); }

// The items of one quantity's budget; those of nothing are left out.
template <typename SigmaOf>
ordered_json BudgetOf(const Estimate& estimate, const SigmaOf& sigma_of) {
  ordered_json json = ordered_json::array();
  for (const uncertainty::BudgetItem& item : estimate.budget) {
    const auto sigma = sigma_of(item.sigma);
    if (IsZero(sigma)) continue;
    json.push_back(ordered_json{
        {"item", item.words.item}, {"sigma", ToJson(sigma)}, {"words", item.words.words}});
  }
  return json;
}

ordered_json LightBudget(const Estimate& estimate, std::size_t light) {
  using uncertainty::Uncertainty;
  const LightEstimate& known = estimate.lights[light];
  ordered_json json;
  json["direction_sigma_deg"] = BudgetOf(
      estimate, [&](const Uncertainty& sigma) { return RadToDeg(sigma.lights[light].direction); });
  json["inverse_distance_sigma"] = BudgetOf(
      estimate, [&](const Uncertainty& sigma) { return sigma.lights[light].inverse_distance; });
  json["distance_sigma"] = nullptr;
  if (known.distance)
    json["distance_sigma"] =
        BudgetOf(estimate, [&](const Uncertainty& sigma) { return sigma.lights[light].distance; });
  json["intensity_sigma"] = nullptr;
  if (known.intensity_sigma)
    json["intensity_sigma"] =
        BudgetOf(estimate, [&](const Uncertainty& sigma) { return sigma.lights[light].intensity; });
  return json;
}

ordered_json ReflectanceBudget(const Estimate& estimate) {
  using uncertainty::Uncertainty;
  const auto of = [&](auto Uncertainty::*member) {
    return BudgetOf(estimate, [member](const Uncertainty& sigma) { return sigma.*member; });
  };
  const auto of_lobe = [&](double uncertainty::LobeSigma::*member) {
    return BudgetOf(estimate,
                    [member](const Uncertainty& sigma) { return sigma.lobes[0].*member; });
  };
  ordered_json json;
  json["albedo"] = of(&Uncertainty::albedo);
  json["ambient"] = of(&Uncertainty::ambient);
  json["diffuse"] = of(&Uncertainty::diffuse);
  json["specular"] =
      HasLobe(estimate) ? of_lobe(&uncertainty::LobeSigma::strength) : ordered_json(nullptr);
  json["shininess"] =
      HasShininess(estimate) ? of_lobe(&uncertainty::LobeSigma::shape) : ordered_json(nullptr);
  if (IsOrenNayar(estimate))
    json["roughness_deg"] =
        BudgetOf(estimate, [](const Uncertainty& sigma) { return RadToDeg(sigma.roughness); });
  if (HasAmbientColour(estimate)) json["ambient_color"] = of(&Uncertainty::ambient_colour);
  if (HasSpecularColour(estimate)) json["specular_color"] = of(&Uncertainty::specular_colour);
  return json;
}

ordered_json ProductsBudget(const Estimate& estimate) {
  using uncertainty::Uncertainty;
  ordered_json json;
  for (const char* key : {"diffuse_sigma", "specular_sigma"}) json[key] = ordered_json::array();
  json["ambient_sigma"] =
      BudgetOf(estimate, [](const Uncertainty& sigma) { return sigma.ambient_product; });
  for (std::size_t i = 0; i < estimate.lights.size(); ++i) {
    json["diffuse_sigma"].push_back(BudgetOf(
        estimate, [i](const Uncertainty& sigma) { return sigma.lights[i].diffuse_product; }));
    json["specular_sigma"].push_back(BudgetOf(
        estimate, [i](const Uncertainty& sigma) { return sigma.lights[i].specular_product[0]; }));
  }
  return json;
}

ordered_json ModelToJson(const Estimate& estimate) {
  ordered_json json;
  json["lights"] = estimate.lights.size();
  json["near"] = ordered_json::array();
  for (const LightEstimate& light : estimate.lights) json["near"].push_back(light.near);
  json["diffuse"] = WordOf(estimate.reflectance.diffuse_model);
  json["specular"] = WordOf(estimate.reflectance.lobes[0].model);
  json["albedo"] = "uniform";
  json["ladder"] = ordered_json::array();
  for (const model::Rung& rung : estimate.ladder)
    json["ladder"].push_back(
        ordered_json{{"rung", rung.rung}, {"accepted", rung.accepted}, {"why", rung.why}});
  return json;
}

ordered_json LightToJson(const LightEstimate& estimate, const uncertainty::LightSigma* stat) {
  ordered_json json;
  json["direction"] = ToJson(estimate.light.direction);
  json["direction_sigma_deg"] = ToJson(RadToDeg(estimate.direction_sigma));
  json["inverse_distance"] = ToJson(estimate.light.inverse_distance);
  json["inverse_distance_sigma"] = ToJson(estimate.inverse_distance_sigma);
  json["distance"] = ToJson(estimate.distance);
  json["distance_sigma"] = ToJson(estimate.distance_sigma);
  json["distance_min"] = ToJson(estimate.distance_min);
  json["position"] = ToJson(estimate.position);
  json["position_covariance"] = ToJson(estimate.position_covariance);
  json["direction_at_reference"] = ToJson(estimate.direction_at_reference);
  json["intensity"] = ToJson(estimate.light.intensity);
  json["intensity_sigma"] = ToJson(estimate.intensity_sigma);
  const bool coloured = estimate.light.color != Eigen::Vector3d::Ones();
  if (coloured) {
    json["color"] = ToJson(estimate.light.color);
    json["color_sigma"] = ToJson(estimate.colour_sigma);
  }
  if (!estimate.light.factors.empty()) {
    json["factors"] = ToJson(estimate.light.factors);
    json["factors_sigma"] = ToJson(estimate.factor_sigma);
  }
  if (stat == nullptr) return json;
  // The statistical part of the sigmas above.
  json["stat"] = ordered_json{
      {"direction_sigma_deg", ToJson(RadToDeg(stat->direction))},
      {"inverse_distance_sigma", ToJson(stat->inverse_distance)},
      {"distance_sigma", estimate.distance ? ToJson(stat->distance) : ordered_json(nullptr)},
      {"intensity_sigma",
       estimate.intensity_sigma ? ToJson(stat->intensity) : ordered_json(nullptr)}};
  if (coloured) json["stat"]["color_sigma"] = ToJson(stat->colour);
  return json;
}

ordered_json SigmaToJson(const Estimate& estimate, const ReflectanceSigma& sigma) {
  ordered_json json;
  json["albedo"] = ToJson(sigma.albedo);
  json["ambient"] = ToJson(sigma.ambient);
  json["diffuse"] = ToJson(sigma.diffuse);
  json["specular"] = HasLobe(estimate) ? ToJson(sigma.lobes[0].strength) : ordered_json(nullptr);
  json["shininess"] = HasShininess(estimate) ? ToJson(sigma.lobes[0].shape) : ordered_json(nullptr);
  if (IsOrenNayar(estimate))
    json["roughness_deg"] =
        sigma.roughness ? ToJson(RadToDeg(*sigma.roughness)) : ordered_json(nullptr);
  if (!estimate.reflectance.harmonics.isZero(0.0))
    json["ambient_harmonics"] = ToJson(sigma.harmonics);
  if (HasAmbientColour(estimate)) json["ambient_color"] = ToJson(sigma.ambient_colour);
  if (HasSpecularColour(estimate)) json["specular_color"] = ToJson(sigma.specular_colour);
  return json;
}

ordered_json LobeSigmaToJson(const std::string& shape_key, bool has_f0, double strength,
                             const std::optional<double>& shape, const std::optional<double>& f0) {
  ordered_json json;
  json["specular"] = ToJson(strength);
  json[shape_key] = ToJson(shape);
  if (has_f0) json["f0"] = ToJson(f0);
  return json;
}

ordered_json LobesToJson(const Estimate& estimate) {
  using uncertainty::LobeSigma;
  ordered_json list = ordered_json::array();
  for (std::size_t k = 0; k < model::kMostLobes; ++k) {
    const model::Lobe& lobe = estimate.reflectance.lobes[k];
    if (!lobe.present()) continue;
    const reflectance::LobeFacts& facts = model::FactsOf(lobe.model);
    ordered_json json{{"model", facts.word}, {"specular", ToJson(lobe.strength)}};
    json[facts.shape_key] = ToJson(lobe.shape);
    if (facts.physical) json["f0"] = ToJson(lobe.f0);
    json["peak"] = ToJson(model::LobePeak(lobe));
    json["fwhm_deg"] = ToJson(LobeWidthDeg(lobe));
    const ReflectanceSigma::OfLobe& sigma = estimate.sigma.lobes[k];
    json["sigma"] =
        LobeSigmaToJson(facts.shape_key, facts.physical, sigma.strength, sigma.shape, sigma.f0);
    if (estimate.has_sigmas) {
      const LobeSigma& stat = estimate.stat.lobes[k];
      json["sigma"]["stat"] =
          LobeSigmaToJson(facts.shape_key, facts.physical, stat.strength, stat.shape,
                          sigma.f0 ? std::optional(stat.f0) : std::nullopt);
      const auto of = [&](double LobeSigma::*member) {
        return BudgetOf(estimate, [k, member](const uncertainty::Uncertainty& item) {
          return item.lobes[k].*member;
        });
      };
      json["sigma"]["budget"] = ordered_json{{"specular", of(&LobeSigma::strength)}};
      json["sigma"]["budget"][facts.shape_key] = of(&LobeSigma::shape);
      if (facts.physical) json["sigma"]["budget"]["f0"] = of(&LobeSigma::f0);
    }
    list.push_back(std::move(json));
  }
  return list;
}

ordered_json ReflectanceToJson(const Estimate& estimate) {
  const model::Reflectance& reflectance = estimate.reflectance;
  ordered_json json;
  json["albedo"] = ToJson(reflectance.albedo);
  json["ambient"] = ToJson(reflectance.ambient);
  json["diffuse"] = ToJson(reflectance.diffuse);
  json["specular"] = HasLobe(estimate) ? ToJson(reflectance.lobes[0].strength) : ordered_json(0.0);
  json["shininess"] =
      HasShininess(estimate) ? ToJson(reflectance.lobes[0].shape) : ordered_json(nullptr);
  if (IsOrenNayar(estimate)) json["roughness_deg"] = ToJson(RadToDeg(reflectance.roughness));
  json["lobe"] = nullptr;
  if (HasLobe(estimate))
    json["lobe"] = ordered_json{{"peak", ToJson(model::LobePeak(reflectance.lobes[0]))},
                                {"fwhm_deg", ToJson(LobeWidthDeg(reflectance.lobes[0]))}};
  if (HasAmbientColour(estimate)) json["ambient_color"] = ToJson(reflectance.ambient_colour);
  if (HasSpecularColour(estimate)) json["specular_color"] = ToJson(reflectance.specular_colour);
  if (!reflectance.harmonics.isZero(0.0)) json["ambient_harmonics"] = ToJson(reflectance.harmonics);
  if (!reflectance.shading.isZero(0.0)) json["diffuse_harmonics"] = ToJson(reflectance.shading);
  if (NeedsLobeList(reflectance)) json["lobes"] = LobesToJson(estimate);
  json["sigma"] = SigmaToJson(estimate, estimate.sigma);
  const uncertainty::Uncertainty& stat = estimate.stat;
  if (!estimate.has_sigmas) return json;
  ReflectanceSigma of_noise;
  of_noise.albedo = stat.albedo;
  of_noise.ambient = stat.ambient;
  of_noise.diffuse = stat.diffuse;
  of_noise.roughness = stat.roughness;
  of_noise.harmonics = stat.harmonics;
  of_noise.ambient_colour = stat.ambient_colour;
  of_noise.specular_colour = stat.specular_colour;
  of_noise.lobes[0] = {stat.lobes[0].strength, stat.lobes[0].shape, std::nullopt};
  json["sigma"]["stat"] = SigmaToJson(estimate, of_noise);
  json["sigma"]["budget"] = ReflectanceBudget(estimate);
  return json;
}

ordered_json ProductsToJson(const Estimate& estimate) {
  ordered_json json;
  for (const char* key : {"diffuse", "diffuse_sigma"}) json[key] = ordered_json::array();
  json["ambient"] = ToJson(estimate.ambient_product);
  json["ambient_sigma"] = ToJson(estimate.ambient_product_sigma);
  for (const char* key : {"specular", "specular_sigma"}) json[key] = ordered_json::array();
  for (const LightEstimate& light : estimate.lights) {
    json["diffuse"].push_back(ToJson(light.diffuse_product));
    json["diffuse_sigma"].push_back(ToJson(light.diffuse_product_sigma));
    json["specular"].push_back(ToJson(light.specular_product[0]));
    json["specular_sigma"].push_back(ToJson(light.specular_product_sigma[0]));
  }
  if (!estimate.has_sigmas) return json;
  ordered_json& stat = json["stat"];
  for (const char* key : {"diffuse_sigma", "specular_sigma"}) stat[key] = ordered_json::array();
  stat["ambient_sigma"] = ToJson(estimate.stat.ambient_product);
  for (const uncertainty::LightSigma& light : estimate.stat.lights) {
    stat["diffuse_sigma"].push_back(ToJson(light.diffuse_product));
    stat["specular_sigma"].push_back(ToJson(light.specular_product[0]));
  }
  json["budget"] = ProductsBudget(estimate);
  return json;
}

ordered_json NotesToJson(const Estimate& estimate) {
  ordered_json json = ordered_json::array();
  const auto add = [&](const Note& note) {
    json.push_back(ordered_json{{"code", note.code}, {"text", note.text}});
  };
  for (const Note& note : estimate.notes) add(note);
  if (estimate.has_sigmas)
    for (const Note& note : NotesOnNulls(estimate)) add(note);
  return json;
}

}  // namespace

double LobeWidthDeg(const model::Lobe& lobe) {
  return 2.0 * RadToDeg(model::MirroredHalfWidth(lobe));
}

std::string ResultToJson(const Estimate& estimate, const std::string& session_name, Method method,
                         const RunTimes& times, const ViewAdvice* next_view) {
  ordered_json json;
  json["format"] = "turnlight-result";
  json["version"] = 1;
  json["session"] = session_name;
  json["method"] = WordOf(method);
  json["reference_point"] = ToJson(estimate.reference_point);
  json["model"] = ModelToJson(estimate);
  json["lights"] = ordered_json::array();
  for (std::size_t i = 0; i < estimate.lights.size(); ++i) {
    json["lights"].push_back(
        LightToJson(estimate.lights[i], estimate.has_sigmas ? &estimate.stat.lights[i] : nullptr));
    if (estimate.has_sigmas) json["lights"].back()["budget"] = LightBudget(estimate, i);
  }
  json["reflectance"] = ReflectanceToJson(estimate);
  json["products"] = ProductsToJson(estimate);
  if (auto correlation = CorrelationToJson(estimate.correlation))
    json["correlation"] = std::move(*correlation);
  json["residual"] = ordered_json{{"initial_rms", ToJson(estimate.initial_rms)},
                                  {"rms", ToJson(estimate.rms)},
                                  {"pixels", estimate.pixels}};
  json["identifiability"] =
      ordered_json{{"condition", ToJson(estimate.condition)}, {"weak", estimate.weak}};
  json["notes"] = NotesToJson(estimate);
  const std::string null_sigmas = estimate.has_sigmas ? NullSigmas(estimate, json) : "";
  if (!null_sigmas.empty())
    json["notes"].push_back(ordered_json{
        {"code", "null-sigma"}, {"text", messages::Text("null-sigma", {{"list", null_sigmas}})}});
  for (const std::string& key : estimate.undetermined)
    json[ordered_json::json_pointer("/" + key)] = nullptr;
  // What the factors are of.
  if (estimate.ToScene().flickers() && !estimate.frames.empty()) json["frames"] = estimate.frames;
  if (next_view != nullptr) json["next_view"] = NextViewToJson(*next_view);
  json["views"] = estimate.views;
  json["distinct_views"] = estimate.distinct_views;
  json["iterations"] = estimate.iterations;
  json["stopped"] = WordOf(estimate.stopped);
  json["time_s"] = ordered_json{{"load", times.load_s},
                                {"initial", estimate.initial_s},
                                {"solve", estimate.solve_s},
                                {"total", times.total_s}};
  if (method == Method::kPaper) {
    json["x-residual-history"] = ordered_json::array();
    for (const IterationRecord& record : estimate.history)
      json["x-residual-history"].push_back(ToJson(record.rms));
  }
  return json.dump(1) + "\n";
}

}  // namespace turnlight::estimator::results
