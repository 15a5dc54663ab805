#include "bench/studies/score.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/angles.h"
#include "base/format.h"

namespace turnlight::studies {
namespace {

using estimator::model::Light;
using estimator::model::Scene;

constexpr const char* kChannels[] = {"r", "g", "b"};

Eigen::Vector3d Vector(const Json& json) {
  return {json[0].get<double>(), json[1].get<double>(), json[2].get<double>()};
}

std::optional<double> Number(const Json& json) {
  return json.is_number() ? std::optional<double>(json.get<double>()) : std::nullopt;
}

// A quantity from an object's key with its sigma and, where given, the statistical part.
void Add(std::vector<Quantity>& out, const std::string& name, int light, double truth,
         const Json& value, const Json& sigma, const Json& stat) {
  if (!value.is_number()) return;
  out.push_back({name, light, truth, value.get<double>(), Number(sigma), Number(stat)});
}

const Json& At(const Json& object, const std::string& key) {
  static const Json kNothing;
  return object.is_object() && object.contains(key) ? object[key] : kNothing;
}
const Json& At(const Json& array, std::size_t index) {
  static const Json kNothing;
  return array.is_array() && index < array.size() ? array[index] : kNothing;
}

void CompareLight(const Scene& truth, const Json& result, const Match& match,
                  std::vector<Quantity>& out) {
  const Light& light = truth.lights[match.truth];
  const Json& found = result["lights"][match.found];
  const int number = static_cast<int>(match.truth);
  const auto stat = [&](const char* key) -> const Json& { return At(At(found, "stat"), key); };
  Add(out, "direction", number, 0.0, match.angle_deg, At(found, "direction_sigma_deg"),
      stat("direction_sigma_deg"));
  Add(out, "inverse_distance", number, light.inverse_distance, found["inverse_distance"],
      At(found, "inverse_distance_sigma"), stat("inverse_distance_sigma"));
  if (light.inverse_distance > 0.0)
    Add(out, "distance", number, 1.0 / light.inverse_distance, found["distance"],
        At(found, "distance_sigma"), stat("distance_sigma"));
  const Json& products = result["products"];
  const Json& products_stat = At(products, "stat");
  const estimator::model::Reflectance& material = truth.reflectance;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto channel = static_cast<Eigen::Index>(c);
    Add(out, std::string("diffuse_") + kChannels[c], number,
        material.albedo[channel] * material.diffuse * light.intensity * light.color[channel],
        At(At(products["diffuse"], match.found), c),
        At(At(products["diffuse_sigma"], match.found), c),
        At(At(At(products_stat, "diffuse_sigma"), match.found), c));
  }
  if (result["model"]["specular"] != "none")
    Add(out, "specular", number, material.lobes[0].strength * light.intensity,
        At(products["specular"], match.found), At(products["specular_sigma"], match.found),
        At(At(products_stat, "specular_sigma"), match.found));
}

void CompareReflectance(const Scene& truth, const Json& result, std::vector<Quantity>& out) {
  const estimator::model::Reflectance& material = truth.reflectance;
  const Json& products = result["products"];
  const Json& found = result["reflectance"];
  const Json& found_stat = At(found["sigma"], "stat");
  for (std::size_t c = 0; c < 3; ++c)
    Add(out, std::string("ambient_") + kChannels[c], -1,
        material.albedo[static_cast<Eigen::Index>(c)] * material.ambient,
        At(products["ambient"], c), At(products["ambient_sigma"], c),
        At(At(At(products, "stat"), "ambient_sigma"), c));
  if (material.lobes[0].strength > 0.0)
    Add(out, "shininess", -1, material.lobes[0].shape, found["shininess"],
        At(found["sigma"], "shininess"), At(found_stat, "shininess"));
  if (material.diffuse_model == estimator::model::DiffuseModel::kOrenNayar)
    Add(out, "roughness_deg", -1, RadToDeg(material.roughness), At(found, "roughness_deg"),
        At(found["sigma"], "roughness_deg"), At(found_stat, "roughness_deg"));
}

std::string Say(const Json& record) {
  double worst = 0.0;
  for (const Json& angle : record["angles_deg"])
    worst = std::max(worst, angle.is_number() ? angle.get<double>() : 180.0);
  return Format("%d of %d lights, worst direction %.3g deg, rms %.3g%s",
                record["lights_found"].get<int>(), record["lights_true"].get<int>(), worst,
                record["rms"].is_number() ? record["rms"].get<double>() : -1.0,
                record["right"].get<bool>() ? "" : "  WRONG COUNT");
}

}  // namespace

std::vector<Match> MatchLights(const std::vector<Eigen::Vector3d>& truth,
                               const std::vector<Eigen::Vector3d>& found) {
  std::vector<Match> pairs, matches;
  for (std::size_t t = 0; t < truth.size(); ++t)
    for (std::size_t f = 0; f < found.size(); ++f)
      pairs.push_back(
          {t, f, RadToDeg(std::atan2(truth[t].cross(found[f]).norm(), truth[t].dot(found[f])))});
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Match& a, const Match& b) { return a.angle_deg < b.angle_deg; });
  for (const Match& pair : pairs) {
    const bool taken = std::any_of(matches.begin(), matches.end(), [&](const Match& m) {
      return m.truth == pair.truth || m.found == pair.found;
    });
    if (!taken) matches.push_back(pair);
  }
  return matches;
}

std::optional<double> Quantity::ErrorInSigmas() const {
  if (!sigma) return std::nullopt;
  const double error = std::abs(Error());
  if (error == 0.0) return 0.0;
  return *sigma > 0.0 ? error / *sigma : std::numeric_limits<double>::infinity();
}

Json ToJson(const Quantity& quantity) {
  const auto optional = [](const std::optional<double>& value) {
    return value ? Rounded(*value, 4) : Json(nullptr);
  };
  return Json::array({quantity.name, quantity.light, Rounded(quantity.truth, 9),
                      Rounded(quantity.value, 9), optional(quantity.sigma),
                      optional(quantity.sigma_stat)});
}

Quantity QuantityFromJson(const Json& json) {
  return {
      json[0],         json[1],        Number(json[2]).value_or(NAN), Number(json[3]).value_or(NAN),
      Number(json[4]), Number(json[5])};
}

std::vector<Quantity> CompareWithTruth(const Scene& truth, const Json& result,
                                       const std::vector<Match>& matches, double max_angle_deg) {
  std::vector<Quantity> quantities;
  for (const Match& match : matches)
    if (match.angle_deg <= max_angle_deg) CompareLight(truth, result, match, quantities);
  CompareReflectance(truth, result, quantities);
  return quantities;
}

Json ScoreDirections(const std::vector<Eigen::Vector3d>& truth,
                     const std::vector<Eigen::Vector3d>& found) {
  Json record;
  record["lights_true"] = truth.size();
  record["lights_found"] = found.size();
  record["right"] = truth.size() == found.size();
  record["angles_deg"] = Json(std::vector<Json>(truth.size()));
  for (const Match& match : MatchLights(truth, found))
    record["angles_deg"][match.truth] = Rounded(match.angle_deg);
  return record;
}

Json Score(const Scene& truth, const Json& result, double same_light_deg) {
  std::vector<Eigen::Vector3d> true_directions, found_directions;
  for (const Light& light : truth.lights) true_directions.push_back(light.direction);
  for (const Json& light : result["lights"]) found_directions.push_back(Vector(light["direction"]));
  Json record = ScoreDirections(true_directions, found_directions);
  const bool right = record["right"];
  const auto matches = MatchLights(true_directions, found_directions);
  // With the right count a light far off is an error to be counted; else it may be another light.
  record["quantities"] = Json::array();
  for (const Quantity& quantity :
       CompareWithTruth(truth, result, matches, right ? 180.0 : same_light_deg))
    record["quantities"].push_back(ToJson(quantity));
  record["diffuse_model"] = result["model"]["diffuse"];
  record["specular_model"] = result["model"]["specular"];
  record["notes"] = Json::array();
  for (const Json& note : result["notes"]) record["notes"].push_back(note["code"]);
  record["weak"] = result["identifiability"]["weak"].size();
  record["distinct_views"] = result["distinct_views"];
  record["rms"] = result["residual"]["rms"].is_number()
                      ? Rounded(result["residual"]["rms"].get<double>(), 3)
                      : Json(nullptr);
  record["pixels"] = result["residual"]["pixels"];
  record["iterations"] = result["iterations"];
  record["time_s"] = Rounded(result["time_s"]["total"].get<double>(), 3);
  record["say"] = Say(record);
  return record;
}

}  // namespace turnlight::studies
