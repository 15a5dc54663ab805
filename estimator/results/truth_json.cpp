#include <nlohmann/json.hpp>

#include "base/angles.h"
#include "estimator/results/scene_json.h"
#include "estimator/results/words.h"

namespace turnlight::estimator::results {
namespace {

using model::DiffuseModel;
using model::Light;
using model::Lobe;
namespace reflectance = model::reflectance;
using model::Reflectance;
using model::Scene;

nlohmann::ordered_json VectorToJson(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

nlohmann::ordered_json TruthLight(const Light& light) {
  nlohmann::ordered_json json;
  json["direction"] = VectorToJson(light.direction);
  json["position"] = nullptr;
  if (light.inverse_distance > 0.0)
    json["position"] = VectorToJson(light.direction / light.inverse_distance);
  json["inverse_distance"] = light.inverse_distance;
  json["intensity"] = light.intensity;
  if (light.color != Eigen::Vector3d::Ones()) json["color"] = VectorToJson(light.color);
  if (!light.factors.empty()) json["factors"] = light.factors;
  return json;
}

}  // namespace

bool NeedsLobeList(const Reflectance& r) {
  return r.lobes[0].present() &&
         (model::FactsOf(r.lobes[0].model).physical || r.lobes[1].present());
}

nlohmann::ordered_json LobeList(const Reflectance& r) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Lobe& lobe : r.lobes) {
    if (!lobe.present()) continue;
    const reflectance::LobeFacts& facts = model::FactsOf(lobe.model);
    auto& json = list.emplace_back();
    json["model"] = facts.word;
    json["specular"] = lobe.strength;
    json[facts.shape_key] = lobe.shape;
    if (facts.physical) json["f0"] = lobe.f0;
  }
  return list;
}

std::string TruthToJson(const Scene& scene, const std::string& note) {
  nlohmann::ordered_json json;
  json["lights"] = nlohmann::ordered_json::array();
  for (const Light& light : scene.lights) json["lights"].push_back(TruthLight(light));
  const Reflectance& r = scene.reflectance;
  auto& out = json["reflectance"];
  out["model"] = WordOf(r.lobes[0].model);
  out["albedo"] = VectorToJson(r.albedo);
  out["ambient"] = r.ambient;
  out["diffuse"] = r.diffuse;
  const Lobe& first = r.lobes[0];
  out["specular"] = first.present() ? first.strength : 0.0;
  const bool listed = NeedsLobeList(r);
  out["shininess"] = first.present() && !listed ? nlohmann::ordered_json(first.shape) : nullptr;
  if (listed) out["lobes"] = LobeList(r);
  const Eigen::Vector3d white = Eigen::Vector3d::Ones();
  if (r.ambient_colour != white) out["ambient_color"] = VectorToJson(r.ambient_colour);
  if (!r.harmonics.isZero(0.0))
    out["ambient_harmonics"] = std::vector<double>(r.harmonics.begin(), r.harmonics.end());
  if (!r.shading.isZero(0.0))
    out["diffuse_harmonics"] = std::vector<double>(r.shading.begin(), r.shading.end());
  if (r.specular_colour != white) out["specular_color"] = VectorToJson(r.specular_colour);
  if (r.diffuse_model != DiffuseModel::kLambert) out["diffuse_model"] = WordOf(r.diffuse_model);
  if (model::FactsOf(r.diffuse_model).has_shape) out["roughness_deg"] = RadToDeg(r.roughness);
  if (!note.empty()) json["note"] = note;
  return json.dump(1) + "\n";
}

}  // namespace turnlight::estimator::results
