#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/statistics.h"
#include "bench/studies/statistics.h"
#include "bench/studies/summary_parts.h"

namespace turnlight::studies {
namespace {

struct Limits {
  double direction_deg, distance, product;
};

// One session's quantities against the limits for its kind of target.
void CheckSession(const Json& record, const Limits& limits, Summary& out) {
  const std::string id = record["id"];
  double direction = 0.0, distance = 0.0, product = 0.0;
  for (const Quantity& quantity : Quantities(record)) {
    const double scale = quantity.truth == 0.0 ? 1.0 : std::abs(quantity.truth);
    const double relative = std::abs(quantity.Error()) / scale;
    if (quantity.name == "direction")
      direction = std::max(direction, quantity.Error());
    else if (quantity.name == "distance")
      distance = std::max(distance, relative);
    else if (quantity.name != "inverse_distance")
      product = std::max(product, relative);
  }
  if (record["specular_model"] == "none" && id.find("matte") == std::string::npos) product = 1.0;
  Accept(out, id + ": count", Right(record) ? 1 : 0, 1, 1.0);
  AcceptAtMost(out, id + ": direction", direction, limits.direction_deg, "deg");
  AcceptAtMost(out, id + ": distance", 100.0 * distance, 100.0 * limits.distance, "%");
  AcceptAtMost(out, id + ": products, shininess", 100.0 * product, 100.0 * limits.product, "%");
}

void CheckPovSigmas(const std::vector<const Json*>& records, Summary& out) {
  std::size_t within = 0, all = 0;
  std::vector<double> errors, sigmas;
  for (const Json* record : records)
    for (const Quantity& quantity : Quantities(*record)) {
      ++all;
      within += quantity.ErrorInSigmas().value_or(INFINITY) <= 3.0 ? 1 : 0;
      const double scale =
          quantity.name == "direction" || quantity.truth == 0.0 ? 1.0 : std::abs(quantity.truth);
      errors.push_back(std::abs(quantity.Error()) / scale);
      sigmas.push_back(quantity.sigma.value_or(INFINITY) / scale);
    }
  Accept(out, "pov: |error| at most 3 sigma_total", within, all, 0.9);
  AcceptAtMost(out, "pov: median sigma_total / median error",
               InterpolatedQuantile(sigmas, 0.5) / InterpolatedQuantile(errors, 0.5), 5.0, "");
}

}  // namespace

Summary SummariseSessions(const StudyFile& file) {
  Summary out;
  const auto records = Measured(file, out.text);
  out.accepted = records.size() == file.records.size();
  std::vector<const Json*> pov;
  std::vector<double> gray;
  for (const Json* record : records) {
    const std::string id = (*record)["id"];
    out.text += SceneLine(*record);
    if (id.starts_with("uw_gray")) gray.push_back(WorstDirection(*record));
    if (!id.starts_with("pov_")) continue;
    pov.push_back(record);
    const bool mesh = id.find("mesh") != std::string::npos;
    CheckSession(*record, mesh ? Limits{0.1, 0.01, 0.02} : Limits{0.02, 0.003, 0.01}, out);
  }
  if (!pov.empty()) CheckPovSigmas(pov, out);
  if (!gray.empty()) {
    double sum = 0.0;
    for (const double angle : gray) sum += angle;
    AcceptAtMost(out, "uw_gray: mean direction", sum / static_cast<double>(gray.size()), 1.6,
                 "deg");
    AcceptAtMost(out, "uw_gray: worst direction", InterpolatedQuantile(gray, 1.0), 3.0, "deg");
  }
  out.text += Times(records) + "\n" + QuantityTable(pov);
  return out;
}

}  // namespace turnlight::studies
