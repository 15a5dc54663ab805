#include "estimator/results/next_view_json.h"

#include <cmath>

#include "base/angles.h"

namespace turnlight::estimator::results {
namespace {

using nlohmann::ordered_json;

ordered_json InDegrees(double radians) {
  return std::isfinite(radians) ? ordered_json(RadToDeg(radians)) : ordered_json(nullptr);
}

ordered_json OrNull(const std::optional<double>& value) {
  return value ? ordered_json(*value) : ordered_json(nullptr);
}

ordered_json ViewToJson(const CandidateView& view, double sigma) {
  return {{"angle_deg", OrNull(view.angle_deg)},
          {"where", view.label},
          {"exposure_us", OrNull(view.exposure.exposure_us)},
          {"direction_sigma_deg", InDegrees(sigma)}};
}

}  // namespace

ordered_json NextViewToJson(const ViewAdvice& advice) {
  ordered_json json;
  for (const char* key : {"light", "direction_sigma_deg", "floor_sigma_deg", "floor", "view",
                          "wanted_deg", "further_views"})
    json[key] = nullptr;
  json["words"] = advice.words;
  if (!advice.found) return json;
  const NextView& found = *advice.found;
  json["light"] = found.light;
  json["direction_sigma_deg"] = InDegrees(found.sigma);
  json["floor_sigma_deg"] = InDegrees(found.floor);
  if (!found.floor_item.empty()) json["floor"] = found.floor_item;
  if (!found.steps.empty())
    json["view"] =
        ViewToJson(advice.candidates[found.steps.front().candidate], found.steps.front().sigma);
  if (found.wanted) json["wanted_deg"] = InDegrees(*found.wanted);
  if (found.reachable()) json["further_views"] = found.reached() ? 0 : found.steps.size();
  return json;
}

}  // namespace turnlight::estimator::results
