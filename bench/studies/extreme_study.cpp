#include <algorithm>
#include <cmath>

#include "base/format.h"
#include "bench/studies/extreme_cells.h"
#include "bench/studies/score.h"
#include "bench/studies/studies.h"
#include "bench/studies/take.h"
#include "estimator/solve/normal_equations.h"

namespace turnlight::studies {
namespace {

// Two lights closer than this share of the lobe's width may be taken for one.
constexpr double kOneLight = 0.2;

bool Close(const estimator::model::Light& a, const estimator::model::Light& b, double angle) {
  return a.direction.dot(b.direction) >= std::cos(angle) &&
         std::abs(a.inverse_distance - b.inverse_distance) < 1e-9;
}

// What of the truth can be known: a light that a surface does not reflect is none, and lights at
// (nearly, if the estimate found fewer) the same place are one.
void KeepKnowable(estimator::model::Scene& scene, std::size_t found) {
  if (scene.reflectance.diffuse == 0.0 && scene.reflectance.lobes[0].strength == 0.0)
    scene.lights.clear();
  const double width = 2.0 * estimator::model::LobeHalfWidth(scene.reflectance.lobes[0]);
  const double angle = found < scene.lights.size() ? kOneLight * width : 1e-7;
  std::vector<estimator::model::Light> merged;
  for (const estimator::model::Light& light : scene.lights) {
    const auto same = std::find_if(merged.begin(), merged.end(),
                                   [&](const auto& other) { return Close(light, other, angle); });
    if (same == merged.end()) {
      merged.push_back(light);
      continue;
    }
    same->direction =
        (same->intensity * same->direction + light.intensity * light.direction).normalized();
    same->intensity += light.intensity;
  }
  scene.lights = merged;
}

// Whether a note says that the data do not determine a key of the result.
bool IsSaidToBeUnknown(const Json& result, const std::string& key) {
  for (const Json& note : result["notes"])
    if (note["code"] == "not-determined" &&
        note["text"].get<std::string>().find(key) != std::string::npos)
      return true;
  return false;
}

// A result without a number where one must be, and no word of why.
bool HasNan(const Json& result) {
  const auto lacks = [&](const Json& value, const std::string& key) {
    const bool null = value.is_null() || (value.is_array() && value[0].is_null());
    return null && !IsSaidToBeUnknown(result, key);
  };
  for (std::size_t l = 0; l < result["lights"].size(); ++l)
    for (const char* key : {"direction", "inverse_distance", "intensity"})
      if (lacks(result["lights"][l][key], Format("lights/%zu/%s", l, key))) return true;
  const Json& reflectance = result["reflectance"];
  return result["residual"]["rms"].is_null() ||
         lacks(reflectance["diffuse"], "reflectance/diffuse") ||
         lacks(reflectance["ambient"], "reflectance/ambient");
}

Json EstimateCell(const ExtremeCell& cell) {
  auto session = cell.make();
  if (!session) return Json{{"failed", session.error().text}};
  Json record{{"group", cell.group}, {"setting", cell.setting}};
  const auto result = EstimateSynthetic(*session);
  if (!result) {  // an answer: there is nothing to estimate, and why
    record["refused"] = record["say"] = result.error().text;
    return record;
  }
  record["nan"] = HasNan(*result);
  if (record["nan"].get<bool>()) return record;
  KeepKnowable(session->scene, (*result)["lights"].size());
  return Joined(record, Score(session->scene, *result));
}

}  // namespace

std::vector<Job> ExtremeJobs() {
  std::vector<Job> jobs;
  for (const ExtremeCell& cell : ExtremeCells()) {
    const std::string id =
        Format("%03zu/%s/%s", jobs.size(), cell.group.c_str(), cell.setting.c_str());
    jobs.push_back({id, [cell] { return EstimateCell(cell); }});
  }
  return jobs;
}

}  // namespace turnlight::studies
