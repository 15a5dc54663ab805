#include "bench/studies/summary.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "bench/studies/statistics.h"
#include "bench/studies/summary_parts.h"

namespace turnlight::studies {
namespace {

bool Right(const Json& record) { return record["right"].get<bool>(); }

// The right count, and every light near its true one.
bool RightBasin(const Json& record, double within_deg) {
  return Right(record) &&
         std::all_of(record["angles_deg"].begin(), record["angles_deg"].end(),
                     [&](const Json& a) { return a.is_number() && a.get<double>() <= within_deg; });
}

std::string Times(const std::vector<const Json*>& records) {
  std::vector<double> times;
  for (const Json* record : records) times.push_back(record->value("time_s", 0.0));
  return Format("  time of an estimate: median %.2g s, 95 %% below %.2g s, longest %.2g s\n",
                Quantile(times, 0.5), Quantile(times, 0.95), Quantile(times, 1.0));
}

// Which notes stand in how many right and wrong records.
std::string NoteTable(const std::vector<const Json*>& records) {
  std::map<std::string, std::pair<int, int>> codes;
  int right = 0, wrong = 0;
  for (const Json* record : records) {
    (Right(*record) ? right : wrong) += 1;
    for (const Json& code : (*record)["notes"]) {
      auto& counts = codes[code.get<std::string>()];
      (Right(*record) ? counts.first : counts.second) += 1;
    }
  }
  std::string text = Format("  notes, in %d right and %d wrong counts:", right, wrong);
  for (const auto& [code, counts] : codes)
    text += Format("  %s %d/%d", code.c_str(), counts.first, counts.second);
  return text + "\n";
}

double WorstDirection(const Json& record) {
  double worst = 0.0;
  for (const Json& angle : record["angles_deg"])
    worst = std::max(worst, angle.is_number() ? angle.get<double>() : 180.0);
  return worst;
}

double WorstDirectionInSigmas(const Json& record) {
  double worst = 0.0;
  for (const Quantity& quantity : Quantities(record))
    if (quantity.name == "direction")
      worst = std::max(worst, quantity.ErrorInSigmas().value_or(INFINITY));
  return worst;
}

std::string SceneLine(const Json& record) {
  return Format(
      "    %-22s %s, %d views, %s, noise %g, n %g, %s (%s found): %d of %d lights, worst direction "
      "%.3g deg = %.3g sigma, rms %g%s\n",
      record["id"].get<std::string>().c_str(),
      record.value("target", std::string("session")).c_str(), record.value("views", 0),
      record.value("sensor", std::string()).c_str(), record.value("noise", 0.0),
      record.value("shininess", 0.0), record.value("diffuse_true", std::string()).c_str(),
      record.value("diffuse_model", std::string()).c_str(), record["lights_found"].get<int>(),
      record["lights_true"].get<int>(), WorstDirection(record), WorstDirectionInSigmas(record),
      record.value("rms", 0.0), WarnedOfCount(record) ? ", warned" : "");
}

std::string WorstScenes(std::vector<const Json*> records, int worst) {
  std::string text = "  wrong counts:\n";
  for (const Json* record : records)
    if (!Right(*record)) text += SceneLine(*record);
  std::erase_if(records, [](const Json* record) { return !Right(*record); });
  std::stable_sort(records.begin(), records.end(), [](const Json* a, const Json* b) {
    return WorstDirectionInSigmas(*a) > WorstDirectionInSigmas(*b);
  });
  text += "  right counts, directions furthest off in sigmas:\n";
  for (std::size_t i = 0; i < std::min(records.size(), static_cast<std::size_t>(worst)); ++i)
    text += SceneLine(*records[i]);
  return text;
}

// Of all directions of some records, how many are within so many sigma.
void CountDirections(const std::vector<const Json*>& records, double limit, std::size_t& good,
                     std::size_t& all) {
  for (const Json* record : records)
    for (const Quantity& quantity : Quantities(*record))
      if (quantity.name == "direction") {
        ++all;
        good += quantity.ErrorInSigmas().value_or(INFINITY) <= limit ? 1 : 0;
      }
}

Summary SummariseRandom(const StudyFile& file, int worst) {
  Summary out;
  const auto records = Measured(file, out.text);
  std::vector<const Json*> right, wrong;
  for (const Json* record : records) (Right(*record) ? right : wrong).push_back(record);
  Accept(out, "number of lights right", right.size(),
         records.size() + static_cast<std::size_t>(std::count_if(
                              file.records.begin(), file.records.end(),
                              [](const auto& r) { return r.second.contains("failed"); })),
         0.95);
  std::size_t good = 0, all = 0;
  CountDirections(records, 3.0, good, all);
  Accept(out, "directions within 3 sigma_total", good, all, 0.95);
  Accept(
      out, "warned, when the number is wrong",
      static_cast<std::size_t>(std::count_if(
          wrong.begin(), wrong.end(), [](const Json* record) { return WarnedOfCount(*record); })),
      wrong.size(), 0.5);
  const auto in_basin = std::count_if(records.begin(), records.end(),
                                      [](const Json* r) { return RightBasin(*r, 1.0); });
  out.text +=
      Format("  all lights within 1 degree, right count: %td of %zu\n", in_basin, records.size());
  out.text += Times(records);
  const auto word = [](const char* key) {
    return [key](const Json& r) { return r.value(key, std::string()); };
  };
  out.text += "\n  right counts by\n";
  out.text += Breakdown(
      records, "lights", [](const Json& r) { return r["lights_true"].dump(); }, Right);
  out.text += Breakdown(records, "target", word("target"), Right);
  out.text += Breakdown(records, "sensor", word("sensor"), Right);
  out.text += Breakdown(records, "diffuse", word("diffuse_true"), Right);
  out.text += Breakdown(
      records, "noise",
      [](const Json& r) {
        const double noise = r.value("noise", 0.0);
        return std::string(noise == 0.0 ? "none" : noise < 0.003 ? "below 0.3 %" : "0.3 to 1 %");
      },
      Right);
  out.text += NoteTable(records);
  out.text += "\n  right counts:\n" + QuantityTable(right) + "\n" + WorstScenes(records, worst);
  return out;
}

struct Limits {
  double direction_deg, distance, product;
};

// One session's quantities against the limits for its kind of target.
void CheckSession(const Json& record, const Limits& limits, Summary& out) {
  const std::string id = record["id"];
  double direction = 0.0, distance = 0.0, product = 0.0;
  for (const Quantity& quantity : Quantities(record)) {
    const double relative = std::abs(quantity.Error() / quantity.truth);
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
               Quantile(sigmas, 0.5) / Quantile(errors, 0.5), 5.0, "");
}

Summary SummariseSessions(const StudyFile& file, int) {
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
    AcceptAtMost(out, "uw_gray: worst direction", Quantile(gray, 1.0), 3.0, "deg");
  }
  out.text += Times(records) + "\n" + QuantityTable(pov);
  return out;
}

}  // namespace

Summary Summarise(const StudyFile& file, int worst) {
  if (file.study == "sessions") return SummariseSessions(file, worst);
  return SummariseRandom(file, worst);
}

}  // namespace turnlight::studies
