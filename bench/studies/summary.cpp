#include "bench/studies/summary.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/format.h"
#include "bench/studies/photograph_summary.h"
#include "bench/studies/summary_parts.h"

namespace turnlight::studies {
namespace {

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
  Accept(out, "number of lights right", right.size(), Attempted(file), 0.95);
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

// Of "eight/ball/20-views/noise-0.01/003": "ball/20-views/noise-0.01".
std::string EightGroup(const Json& record) {
  const std::string id = record["id"];
  return id.substr(6, id.rfind('/') - 6);
}

// What the paper's method found beside: lights, those within 5 degrees of a true one, its rms.
std::string PaperTable(const std::vector<const Json*>& records) {
  constexpr double kNearDeg = 5.0;
  std::string text = "    scene                                   lights  within 5 deg       rms\n";
  for (const Json* record : records) {
    const Json paper = record->value("paper", Json::object());
    if (!paper.contains("angles_deg")) {
      text += Format("    %-38s %s\n", (*record)["id"].get<std::string>().c_str(),
                     paper.value("failed", std::string("not run")).c_str());
      continue;
    }
    const Json& angles = paper["angles_deg"];
    const auto near = std::count_if(angles.begin(), angles.end(), [](const Json& a) {
      return a.is_number() && a.get<double>() <= kNearDeg;
    });
    text += Format("    %-38s %7d %13td %9.2g\n", (*record)["id"].get<std::string>().c_str(),
                   paper["lights_found"].get<int>(), near, paper.value("rms", 0.0));
  }
  return text;
}

Summary SummariseEight(const StudyFile& file, int worst) {
  Summary out;
  const auto records = Measured(file, out.text);
  const auto all_found = [](const Json& record) { return RightBasin(record, 0.5); };
  Accept(
      out, "all eight within 0.5 degree, none too many",
      static_cast<std::size_t>(std::count_if(
          records.begin(), records.end(), [&](const Json* record) { return all_found(*record); })),
      Attempted(file), 1.0);
  out.text += Breakdown(records, "found", EightGroup, all_found) + Times(records);
  out.text += "\n  the paper's method on the same pictures\n";
  out.text += PaperTable(records);
  out.text += "\n" + QuantityTable(records) + "\n" + WorstScenes(records, worst);
  return out;
}

Summary SummariseHandStart(const StudyFile& file, int worst) {
  Summary out;
  const auto records = Measured(file, out.text);
  const auto basin = [](const Json& record) { return RightBasin(record, 1.0); };
  Accept(out, "right basin: right count, all within 1 degree",
         static_cast<std::size_t>(std::count_if(
             records.begin(), records.end(), [&](const Json* record) { return basin(*record); })),
         Attempted(file), 0.95);
  out.text += Breakdown(
      records, "lights", [](const Json& r) { return r["lights_true"].dump(); }, basin);
  out.text += Breakdown(
      records, "target", [](const Json& r) { return r.value("target", std::string()); }, basin);
  out.text += Times(records) + WorstScenes(records, worst);
  return out;
}

}  // namespace

Summary Summarise(const StudyFile& file, int worst) {
  if (file.study == "sessions") return SummariseSessions(file);
  if (file.study == "photographs") return SummarisePhotographs(file);
  if (file.study == "coverage") return SummariseCoverage(file);
  if (file.study == "extremes") return SummariseExtremes(file);
  if (file.study == "lights") return SummariseLights(file);
  if (file.study == "hard") return SummariseHard(file, worst);
  if (file.study == "eight") return SummariseEight(file, worst);
  if (file.study == "handstart") return SummariseHandStart(file, worst);
  return SummariseRandom(file, worst);
}

}  // namespace turnlight::studies
