#include <cstdio>

#include "bench/studies/extreme_cells.h"
#include "bench/studies/score.h"
#include "bench/studies/studies.h"
#include "bench/studies/take.h"

namespace turnlight::studies {
namespace {

// Lights at the same place are one light.
void MergeCoincident(estimator::Scene& scene) {
  std::vector<estimator::Light> merged;
  for (const estimator::Light& light : scene.lights) {
    bool joined = false;
    for (estimator::Light& other : merged)
      if (other.direction.isApprox(light.direction) &&
          other.inverse_distance == light.inverse_distance) {
        other.intensity += light.intensity;
        joined = true;
      }
    if (!joined) merged.push_back(light);
  }
  scene.lights = merged;
}

// A result without a number where one must be.
bool HasNan(const Json& result) {
  for (const Json& light : result["lights"])
    for (const char* key : {"direction", "inverse_distance", "intensity"})
      if (light[key].is_null() || (light[key].is_array() && light[key][0].is_null())) return true;
  return result["residual"]["rms"].is_null() || result["reflectance"]["diffuse"].is_null() ||
         result["reflectance"]["ambient"].is_null();
}

Json EstimateCell(const ExtremeCell& cell) {
  auto session = cell.make();
  if (!session) return Json{{"failed", session.error().text}};
  MergeCoincident(session->scene);
  Json record{{"group", cell.group}, {"setting", cell.setting}};
  const auto result = EstimateSynthetic(*session);
  if (!result) {  // an answer: there is nothing to estimate, and why
    record["refused"] = result.error().text;
    return record;
  }
  record["nan"] = HasNan(*result);
  if (record["nan"].get<bool>()) return record;
  return Joined(record, Score(session->scene, *result));
}

}  // namespace

std::vector<Job> ExtremeJobs() {
  std::vector<Job> jobs;
  for (const ExtremeCell& cell : ExtremeCells()) {
    char id[96];
    std::snprintf(id, sizeof id, "%03zu/%s/%s", jobs.size(), cell.group.c_str(),
                  cell.setting.c_str());
    jobs.push_back({id, [cell] { return EstimateCell(cell); }});
  }
  return jobs;
}

}  // namespace turnlight::studies
