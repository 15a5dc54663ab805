#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "base/format.h"
#include "bench/studies/statistics.h"
#include "bench/studies/summary_parts.h"

namespace turnlight::studies {
namespace {

constexpr double kSixtyEight = 0.6827;  // within 1 sigma
constexpr double kNinetyFive = 0.95;    // within 1.96 sigma
constexpr double kBandLevel = 0.99;

struct Errors {
  std::vector<double> total, stat;  // in sigmas
};

int Within(const std::vector<double>& errors, double limit) {
  int count = 0;
  for (const double error : errors) count += std::abs(error) <= limit ? 1 : 0;
  return count;
}

// "  70.1 % in [65.2, 71.3] holds"
std::string Share(const std::vector<double>& errors, double limit, double probability,
                  bool& holds) {
  const int trials = static_cast<int>(errors.size());
  const Band band = BinomialBand(trials, probability, kBandLevel);
  const int within = Within(errors, limit);
  holds = band.low <= within && within <= band.high;
  const double percent = 100.0 / std::max(trials, 1);
  return Format("  %5.1f %% in [%4.1f, %4.1f] %s", percent * within, percent * band.low,
                percent * band.high, holds ? "holds" : "FAILS");
}

std::vector<double> Numbers(const Json& json) {
  std::vector<double> numbers;
  for (const Json& number : json)
    numbers.push_back(number.is_number() ? number.get<double>() : INFINITY);
  return numbers;
}

void Append(std::vector<double>& to, const std::vector<double>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

}  // namespace

Summary SummariseCoverage(const StudyFile& file) {
  Summary out;
  std::map<std::string, Errors> by_name;
  int draws = 0, wrong = 0, scenes = 0;
  for (const Json* record : Measured(file, out.text)) {
    ++scenes;
    draws += (*record)["draws"].get<int>();
    wrong += (*record)["wrong_counts"].get<int>();
    for (const Json& entry : (*record)["errors"]) {
      Errors& errors = by_name[entry[0].get<std::string>()];
      Append(errors.total, Numbers(entry[2]));
      Append(errors.stat, Numbers(entry[3]));
    }
  }
  out.text += Format("  %d scenes, %d draws, of which %d with a wrong count are left out\n", scenes,
                     draws, wrong);
  Accept(out, "draws with the right number of lights", static_cast<std::size_t>(draws - wrong),
         static_cast<std::size_t>(draws), 0.95);
  out.text +=
      "  sigma_total               values  within 1 sigma                    within 1.96 sigma\n";
  std::string stat = "  sigma_stat\n";
  for (const auto& [name, errors] : by_name) {
    bool first = true, second = true;
    const std::string row = Share(errors.total, 1.0, kSixtyEight, first) +
                            Share(errors.total, 1.96, kNinetyFive, second);
    const bool counts = name != "shininess" && name != "roughness_deg" &&
                        name != "inverse_distance_distant" && !name.ends_with("_open");
    if (counts) out.accepted &= first && second;
    out.text += Format("  %-24s %6zu", name.c_str(), errors.total.size()) + row + "\n";
    if (!errors.stat.empty())
      stat += Format("  %-24s %6zu", name.c_str(), errors.stat.size()) +
              Share(errors.stat, 1.0, kSixtyEight, first) +
              Share(errors.stat, 1.96, kNinetyFive, second) + "\n";
  }
  out.text += stat;
  return out;
}

}  // namespace turnlight::studies
