#include "bench/studies/report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/file.h"
#include "base/format.h"
#include "bench/studies/photograph_summary.h"
#include "bench/studies/summary_parts.h"
#include "bench/studies/svg_chart.h"

namespace turnlight::studies {
namespace {

constexpr int kWorstListed = 8;

std::string Commits(const StudyFile& file) {
  std::set<std::string> commits;
  for (const auto& [id, record] : file.records) commits.insert(record.value("commit", "?"));
  return Listed({commits.begin(), commits.end()});
}

std::string Section(const StudyFile& file, const std::string& title, const std::string& what) {
  return "\n## " + title + "\n\n" + what + " Made by `build/release/study " + file.study +
         " --out bench/studies/results/" + file.study + ".json` at commit " + Commits(file) +
         ".\n\n```\n" + Summarise(file, kWorstListed).text + "```\n";
}

// The share of values at or below each abscissa.
Series Cumulative(const std::string& name, std::vector<double> values, double high) {
  std::sort(values.begin(), values.end());
  Series series{name, {}, false, false};
  for (int i = 0; i <= 100; ++i) {
    const double at = high * i / 100.0;
    const auto count = std::upper_bound(values.begin(), values.end(), at) - values.begin();
    series.points.emplace_back(
        at, 100.0 * static_cast<double>(count) / static_cast<double>(values.size()));
  }
  return series;
}

using Chooser = std::function<bool(const std::string&)>;

std::vector<double> ErrorsInSigmas(const std::vector<const Json*>& records, const Chooser& chosen) {
  std::vector<double> values;
  for (const Json* record : records)
    for (const Quantity& quantity : Quantities(*record))
      if (chosen(quantity.name)) values.push_back(quantity.ErrorInSigmas().value_or(INFINITY));
  return values;
}

std::string HonestyPlot(const std::vector<const Json*>& records) {
  constexpr double kHigh = 5.0;
  const std::pair<const char*, Chooser> groups[] = {
      {"directions", [](const std::string& n) { return n == "direction"; }},
      {"1/distance", [](const std::string& n) { return n == "inverse_distance"; }},
      {"diffuse products", [](const std::string& n) { return n.starts_with("diffuse_"); }},
      {"specular products", [](const std::string& n) { return n == "specular"; }},
      {"shininess", [](const std::string& n) { return n == "shininess"; }}};
  std::vector<Series> series;
  for (const auto& [name, chosen] : groups)
    series.push_back(Cumulative(name, ErrorsInSigmas(records, chosen), kHigh));
  Series normal{"normal", {}, false, true};
  for (int i = 0; i <= 100; ++i) {
    const double at = kHigh * i / 100.0;
    normal.points.emplace_back(at, 100.0 * std::erf(at / std::sqrt(2.0)));
  }
  series.push_back(normal);
  return SvgChart("How far off, in stated sigmas", {"|error| / sigma_total", 0.0, kHigh, false},
                  {"% of the quantities", 0.0, 100.0, false}, series);
}

std::string DirectionPlot(const std::vector<const Json*>& records) {
  std::map<std::string, Series> by_target;
  for (const Json* record : records) {
    Series& series = by_target[record->value("target", std::string())];
    series.dots = true;
    const double noise = std::max(1e-4, record->value("noise", 0.0));
    for (const Json& angle : (*record)["angles_deg"])
      if (angle.is_number()) series.points.emplace_back(noise, angle.get<double>());
  }
  std::vector<Series> series;
  for (auto& [name, one] : by_target) {
    one.name = name;
    series.push_back(one);
  }
  return SvgChart("Every light of the random scenes",
                  {"noise, share of white (none at the left edge)", 1e-4, 1e-2, true},
                  {"direction off by, degrees", 1e-5, 10.0, true}, series);
}

std::string CountPlot(const std::vector<const Json*>& records) {
  std::map<int, std::pair<int, int>> by_lights;
  for (const Json* record : records) {
    auto& [right, all] = by_lights[(*record)["lights_true"].get<int>()];
    right += Right(*record) ? 1 : 0;
    ++all;
  }
  Series line{"", {}, false, false}, dots{"", {}, true, false};
  for (const auto& [lights, counts] : by_lights)
    line.points.emplace_back(lights, 100.0 * counts.first / counts.second);
  dots.points = line.points;
  return SvgChart("Number of lights found right", {"true number of lights", 0.0, 9.0, false},
                  {"% of the scenes", 0.0, 100.0, false}, {line, dots});
}

Result<std::string> RandomSection(const StudyFile& file, const std::filesystem::path& docs) {
  std::string ignored;
  const auto records = Measured(file, ignored);
  const std::pair<const char*, std::string> plots[] = {{"honesty.svg", HonestyPlot(records)},
                                                       {"directions.svg", DirectionPlot(records)},
                                                       {"counts.svg", CountPlot(records)}};
  std::string text = Section(file, "Random scenes without a hint",
                             "The generator is stated in `bench/studies/random_scene.h`.");
  for (const auto& [name, svg] : plots) {
    if (const Status status = WriteFileAtomic(docs / "accuracy" / name, svg); !status)
      return Forward(status);
    text += std::string("\n![](accuracy/") + name + ")\n";
  }
  return text;
}

std::string PhotographPlot(const StudyFile& file) {
  constexpr double kHigh = 2.0;
  std::vector<Series> series;
  for (const char* method : kPhotographMethods) {
    auto errors = PhotographErrors(file, "ball-", method);
    if (!errors.empty())
      series.push_back(Cumulative(WordsOfMethod(method), std::move(errors), kHigh));
  }
  return SvgChart("Photographs of a glossy ball, 1 to 4 lights",
                  {"direction off by at most, degrees", 0.0, kHigh, false},
                  {"% of the lights, their number being right", 0.0, 100.0, false}, series);
}

Result<std::string> PhotographSection(const std::filesystem::path& results,
                                      const std::filesystem::path& docs) {
  const char* title = "Real photographs";
  if (!std::filesystem::exists(results / "photographs.json"))
    return std::string("\n## ") + title +
           "\n\nNot measured: there is no `photographs.json` with the results.\n";
  const auto file = ReadStudyFile(results / "photographs.json");
  if (!file) return Forward(file);
  if (const Status status =
          WriteFileAtomic(docs / "accuracy" / "photographs.svg", PhotographPlot(*file));
      !status)
    return Forward(status);
  return Section(*file, title,
                 "A glossy ball (DiLiGenT; its highlights are clipped) and a gray, veined one, one "
                 "view each, under one light and with several photographs added up "
                 "(`bench/studies/photographs.h`). Beside turnlight the paper's method and a short "
                 "script that mirrors the view at the middle of each highlight "
                 "(`bench/peers/highlight_centroids.py`). The photographs are not part of the "
                 "repository.") +
         "\n![](accuracy/photographs.svg)\n";
}

std::string CellRow(const Json& record) {
  const std::string begin = "| " + record["setting"].get<std::string>() + " | ";
  const std::string time = Format("%.2g s", record.value("job_s", 0.0));
  if (record.contains("refused"))
    return begin + "refused | | | | " + time + " | " + record["refused"].get<std::string>() +
           " |\n";
  const auto notes = Listed(record["notes"].get<std::vector<std::string>>());
  double sigma = 0.0;
  const Quantity* worst = nullptr;
  const auto quantities = Quantities(record);
  for (const Quantity& quantity : quantities) {
    if (quantity.name == "direction") sigma = std::max(sigma, quantity.sigma.value_or(INFINITY));
    if (!worst ||
        quantity.ErrorInSigmas().value_or(INFINITY) > worst->ErrorInSigmas().value_or(INFINITY))
      worst = &quantity;
  }
  return begin +
         Format("%d of %d | %.3g | %.2g | %s %.3g | ", record["lights_found"].get<int>(),
                record["lights_true"].get<int>(), WorstDirection(record), sigma,
                worst ? worst->name.c_str() : "",
                worst ? worst->ErrorInSigmas().value_or(INFINITY) : 0.0) +
         Format("%.2g s | ", record.value("time_s", 0.0)) + notes + " |\n";
}

std::string StabilityPage(const StudyFile& file, const Json& reasons) {
  std::string text =
      "# What happens at the extremes\n\nOne plain scene (`bench/studies/extreme_cells.h`), and "
      "one "
      "thing at a time taken to its extreme. Made by `build/release/study extremes --out "
      "bench/studies/results/extremes.json` and `build/release/study report` at commit " +
      Commits(file) +
      ". `direction` is the worst light's error in degrees (180: not found), `sigma` the largest "
      "stated one; `worst` is the quantity with the largest error, in stated sigmas. Times are of "
      "one thread.\n\n```\n" +
      Summarise(file, kWorstListed).text + "```\n";
  std::string group, remarks;
  for (const auto& [id, record] : file.records) {
    if (record.contains("failed") || record.value("nan", false)) continue;
    if (record["group"] != group) {
      group = record["group"];
      text += "\n## " + group + "\n\n" + reasons.value(group, std::string()) +
              (reasons.contains(group) ? "\n\n" : "") +
              "| setting | lights | direction | sigma | worst | time | said |\n"
              "|---|---|---|---|---|---|---|\n";
    }
    text += CellRow(record);
  }
  std::string cells;
  for (const auto& [id, record] : file.records) {
    if (!record.contains("group")) continue;
    const std::string key =
        record["group"].get<std::string>() + "/" + record["setting"].get<std::string>();
    if (reasons.contains(key)) cells += "- " + key + ": " + reasons[key].get<std::string>() + "\n";
  }
  return text + (cells.empty() ? "" : "\n## Reasons\n\n" + cells);
}

// Of each study in the page, after the photographs and the random scenes: its name, a title, and
// what it is.
constexpr std::array<std::array<const char*, 3>, 7> kSections = {
    {{"eight", "Eight lights",
      "Three lights around the zenith and five lower down, over a ball and over a lump with "
      "hollows."},
     {"shifted", "The target a ten-thousandth of its radius elsewhere",
      "The random scenes, nothing of which may hang on that."},
     {"hard", "Is a wrong number of lights said to be uncertain?",
      "Random scenes made hard on purpose, each in one of six ways (`bench/studies/studies.h`). "
      "What is judged is the note `count-uncertain`."},
     {"lights", "Coloured lights, lights that change, light fields",
      "Scenes of their own (`bench/studies/light_study.cpp`), some of each kind without what is "
      "looked for."},
     {"handstart", "Started by hand",
      "The random scenes, each light's direction given 10 to 70 degrees off."},
     {"coverage", "Do the intervals hold the truth?",
      "20 draws of noise each; in brackets the band that holds 99 % of the binomial "
      "distribution. The error of a direction is taken along the worst axis of its stated "
      "covariance (of a distant light, of the other draws' errors). `_open`: sigma_total is more "
      "than ten times sigma_stat, for what the scene leaves open (a board under one light may be "
      "rough): its error is the same in every draw, which noise cannot test; "
      "`_distant`: the truth is at the bound 0."},
     {"sessions", "Pictures that other programs made, and photographs",
      "They are not part of the repository."}}};

}  // namespace

Status WriteReport(const std::filesystem::path& results, const std::filesystem::path& docs) {
  if (const Status status = MakeDirectory(docs / "accuracy"); !status) return status;
  std::string text =
      "# How right the estimates are\n\nMeasured on scenes whose truth is known, by "
      "`bench/studies`; this page is made by `build/release/study report`. An error is in sigmas "
      "of the `sigma_total` that the result states; `% within` counts quantities, each light's "
      "apart.\n";
  const auto photographs = PhotographSection(results, docs);
  if (!photographs) return Forward(photographs);
  text += *photographs;
  const auto read = [&](const char* name) {
    return ReadStudyFile(results / (std::string(name) + ".json"));
  };
  if (const auto file = read("random")) {
    const auto section = RandomSection(*file, docs);
    if (!section) return Forward(section);
    text += *section;
  }
  for (const auto& [name, title, what] : kSections)
    if (const auto file = read(name)) text += Section(*file, title, what);
  if (const Status status = WriteFileAtomic(docs / "accuracy.md", text); !status) return status;
  const auto extremes = read("extremes");
  if (!extremes) return {};
  const auto bytes = ReadFile(results / "reasons.json");
  const Json reasons = bytes ? Json::parse(*bytes, nullptr, false) : Json::object();
  if (reasons.is_discarded()) return InputError((results / "reasons.json").string() + ": not JSON");
  return WriteFileAtomic(docs / "stability.md", StabilityPage(*extremes, reasons));
}

}  // namespace turnlight::studies
