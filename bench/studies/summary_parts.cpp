#include "bench/studies/summary_parts.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/format.h"
#include "base/statistics.h"
#include "bench/studies/statistics.h"

namespace turnlight::studies {
namespace {

// The notes that say that the number of lights may be wrong.
constexpr const char* kCountWarnings[] = {"count-uncertain"};

struct Column {
  std::vector<double> in_sigmas;  // infinite where sigma is null
  std::vector<double> relative;
  std::vector<double> errors, sigmas;
};

std::string Row(const std::string& name, const Column& column) {
  std::string text = Format("  %-18s %6zu", name.c_str(), column.in_sigmas.size());
  for (const double limit : {1.0, 2.0, 3.0, 4.0}) {
    const auto within = std::count_if(column.in_sigmas.begin(), column.in_sigmas.end(),
                                      [&](double z) { return z <= limit; });
    text += Format("  %5.1f", 100.0 * static_cast<double>(within) /
                                  static_cast<double>(column.in_sigmas.size()));
  }
  return text +
         Format(
             "  %8.3g  %8.3g  %9.3g  %9.3g\n", InterpolatedQuantile(column.in_sigmas, 0.5),
             InterpolatedQuantile(column.in_sigmas, 1.0),
             InterpolatedQuantile(column.relative, 0.5),
             InterpolatedQuantile(column.sigmas, 0.5) / InterpolatedQuantile(column.errors, 0.5));
}

}  // namespace

void Accept(Summary& summary, const std::string& what, std::size_t good, std::size_t all,
            double wanted_share) {
  if (all == 0) {
    summary.text += Format("  none   %-46s nothing to judge\n", what.c_str());
    return;
  }
  const double share = static_cast<double>(good) / static_cast<double>(all);
  const bool holds = share >= wanted_share;
  summary.accepted &= holds;
  summary.text +=
      Format("  %-6s %-46s %zu of %zu = %.1f %%, wanted %.0f %%\n", holds ? "holds" : "FAILS",
             what.c_str(), good, all, 100.0 * share, 100.0 * wanted_share);
}

void AcceptAtMost(Summary& summary, const std::string& what, double value, double limit,
                  const char* unit) {
  const bool holds = value <= limit;
  summary.accepted &= holds;
  summary.text += Format("  %-6s %-46s %.3g %s, at most %g\n", holds ? "holds" : "FAILS",
                         what.c_str(), value, unit, limit);
}

std::vector<Quantity> Quantities(const Json& record) {
  std::vector<Quantity> quantities;
  for (const Json& json : record["quantities"]) quantities.push_back(QuantityFromJson(json));
  return quantities;
}

std::string QuantityTable(const std::vector<const Json*>& records) {
  std::map<std::string, Column> columns;
  for (const Json* record : records)
    for (const Quantity& quantity : Quantities(*record)) {
      Column& column = columns[quantity.name];
      column.in_sigmas.push_back(quantity.ErrorInSigmas().value_or(INFINITY));
      column.errors.push_back(std::abs(quantity.Error()));
      column.sigmas.push_back(quantity.sigma.value_or(INFINITY));
      if (quantity.name == "direction" || quantity.truth == 0.0)
        column.relative.push_back(std::abs(quantity.Error()));
      else
        column.relative.push_back(std::abs(quantity.Error() / quantity.truth));
    }
  std::string text =
      "  quantity            count  % within 1, 2, 3, 4 sigma     |error|/sigma      median error "
      " median sigma\n"
      "                                                         median   largest  (deg, rel.)  "
      "/ median error\n";
  for (const auto& [name, column] : columns) text += Row(name, column);
  return text;
}

std::string Breakdown(const std::vector<const Json*>& records, const std::string& title,
                      const std::function<std::string(const Json&)>& group,
                      const std::function<bool(const Json&)>& right) {
  std::map<std::string, std::pair<int, int>> groups;
  for (const Json* record : records) {
    auto& [good, all] = groups[group(*record)];
    good += right(*record) ? 1 : 0;
    ++all;
  }
  std::string text = Format("  %-10s", title.c_str());
  for (const auto& [name, counts] : groups)
    text += Format("  %s: %d/%d", name.c_str(), counts.first, counts.second);
  return text + "\n";
}

std::vector<const Json*> Measured(const StudyFile& file, std::string& text) {
  std::vector<const Json*> records;
  for (const auto& [id, record] : file.records) {
    if (record.contains("failed"))
      text += "  no result  " + id + ": " + record["failed"].get<std::string>() + "\n";
    else if (record.contains("left_out"))
      text += "  left out   " + id + ": " + record["left_out"].get<std::string>() + "\n";
    else
      records.push_back(&record);
  }
  return records;
}

std::size_t Attempted(const StudyFile& file) {
  return static_cast<std::size_t>(
      std::count_if(file.records.begin(), file.records.end(),
                    [](const auto& record) { return !record.second.contains("left_out"); }));
}

bool Right(const Json& record) { return record["right"].get<bool>(); }

bool RightBasin(const Json& record, double within_deg) {
  return Right(record) &&
         std::all_of(record["angles_deg"].begin(), record["angles_deg"].end(),
                     [&](const Json& a) { return a.is_number() && a.get<double>() <= within_deg; });
}

std::string Times(const std::vector<const Json*>& records) {
  std::vector<double> times;
  for (const Json* record : records) times.push_back(record->value("time_s", 0.0));
  return Format("  time of an estimate: median %.2g s, 95 %% below %.2g s, longest %.2g s\n",
                InterpolatedQuantile(times, 0.5), InterpolatedQuantile(times, 0.95),
                InterpolatedQuantile(times, 1.0));
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

bool WarnedOfCount(const Json& record) {
  return std::any_of(std::begin(kCountWarnings), std::end(kCountWarnings), [&](const char* code) {
    const Json& notes = record["notes"];
    return std::find(notes.begin(), notes.end(), code) != notes.end();
  });
}

}  // namespace turnlight::studies
