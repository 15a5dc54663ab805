#include "estimator/results/null_notes.h"

#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>

#include "base/messages/messages.h"

namespace turnlight::estimator::results {
namespace {

using nlohmann::ordered_json;

// "1", "1 and 3", "1, 2 and 3": lights as people count them.
std::string List(const std::vector<std::size_t>& numbers) {
  std::string text;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (i > 0) text += i + 1 == numbers.size() ? " and " : ", ";
    text += std::to_string(numbers[i]);
  }
  return text;
}

// The sigmas that came out null: "lights/0/direction_sigma_deg", ...
void CollectNullSigmas(const ordered_json& json, const std::string& path, std::string& list) {
  const bool is_sigma = path.find("sigma") != std::string::npos;
  const bool explained =
      path.ends_with("distance_sigma") && !path.ends_with("inverse_distance_sigma");
  if (json.is_null() && is_sigma && !explained) list += (list.empty() ? "" : ", ") + path;
  if (json.is_structured())
    for (const auto& [key, value] : json.items())
      CollectNullSigmas(value, std::string(path).append("/").append(key), list);
}

// Of a list's element without what repeats it.
ordered_json WithoutParts(ordered_json json) {
  for (const char* key : {"stat", "budget"}) json.erase(key);
  return json;
}

// Those of the lobes of a list. An F0 that the fit held has none, which the rung "fresnel" says.
void CollectOfLobes(const Estimate& estimate, const ordered_json& lobes, std::string& list) {
  for (std::size_t k = 0; k < lobes.size(); ++k) {
    ordered_json sigma = WithoutParts(lobes[k]["sigma"]);
    if (estimate.stat.lobes[k].f0 == 0.0) sigma.erase("f0");
    CollectNullSigmas(sigma, "reflectance/lobes/" + std::to_string(k) + "/sigma", list);
  }
}

}  // namespace

std::vector<Note> NotesOnNulls(const Estimate& estimate) {
  std::vector<Note> notes;
  const auto add = [&notes](const std::string& id, const messages::Values& values) {
    notes.push_back({messages::CodeOf(id), messages::Text(id, values)});
  };
  std::vector<std::size_t> unbounded;
  for (std::size_t i = 0; i < estimate.lights.size(); ++i)
    if (!estimate.lights[i].distance_min) unbounded.push_back(i + 1);
  if (!unbounded.empty()) add("null-distance-min", {{"lights", List(unbounded)}});
  if (!estimate.lights.empty() && !estimate.lights.front().intensity_sigma)
    add("null-intensity-sigma", {});
  if (!std::isfinite(estimate.condition)) add("null-condition", {});
  return notes;
}

std::string NullSigmas(const Estimate& estimate, const ordered_json& json) {
  std::string list;
  for (std::size_t i = 0; i < estimate.lights.size(); ++i) {
    ordered_json light = WithoutParts(json["lights"][i]);
    if (i == 0) light.erase("intensity_sigma");
    CollectNullSigmas(light, "lights/" + std::to_string(i), list);
  }
  const ordered_json& reflectance = json["reflectance"];
  ordered_json sigma = WithoutParts(reflectance["sigma"]);
  const model::Lobe& lobe = estimate.reflectance.lobes[0];
  if (!lobe.present()) sigma.erase("specular");
  if (!lobe.present() || model::FactsOf(lobe.model).physical) sigma.erase("shininess");
  CollectNullSigmas(sigma, "reflectance/sigma", list);
  if (reflectance.contains("lobes")) CollectOfLobes(estimate, reflectance["lobes"], list);
  CollectNullSigmas(WithoutParts(json["products"]), "products", list);
  return list;
}

}  // namespace turnlight::estimator::results
