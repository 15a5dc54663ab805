#include "app/doctor/report.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/format.h"
#include "base/junit.h"

namespace turnlight::app {
namespace {

constexpr int kVerdictWidth = 9;
constexpr int kNameWidth = 24;

int CountOf(const std::vector<Check>& checks, Verdict verdict) {
  return static_cast<int>(
      std::count_if(checks.begin(), checks.end(),
                    [verdict](const Check& check) { return check.verdict == verdict; }));
}

// Lines after the first stand below it.
std::string Indented(const std::string& text, int columns) {
  std::string out;
  for (const char c : text) {
    out += c;
    if (c == '\n') out += std::string(static_cast<std::size_t>(columns), ' ');
  }
  return out;
}

}  // namespace

std::string WordOf(Verdict verdict) {
  switch (verdict) {
    case Verdict::kOk:
      return "ok";
    case Verdict::kWarning:
      return "warning";
    case Verdict::kFailed:
      return "failed";
    case Verdict::kSkipped:
      return "skipped";
  }
  return "";
}

std::string CheckText(const Check& check) {
  const int columns = kVerdictWidth + kNameWidth;
  std::string text = Format("%-*s%-*s", kVerdictWidth, WordOf(check.verdict).c_str(), kNameWidth,
                            check.name.c_str()) +
                     Indented(check.figure, columns) + "\n";
  if (!check.advice.empty())
    text += std::string(static_cast<std::size_t>(columns), ' ') + "-> " +
            Indented(check.advice, columns + 3) + "\n";
  return text;
}

std::string CountText(const std::vector<Check>& checks) {
  return Format("%zu checks: %d ok, %d warnings, %d failed, %d skipped\n", checks.size(),
                CountOf(checks, Verdict::kOk), CountOf(checks, Verdict::kWarning),
                CountOf(checks, Verdict::kFailed), CountOf(checks, Verdict::kSkipped));
}

std::string ChecksJson(const std::string& config, const std::vector<Check>& checks) {
  nlohmann::ordered_json json = {{"config", config},
                                 {"checks", nlohmann::ordered_json::array()},
                                 {"failed", CountOf(checks, Verdict::kFailed)}};
  for (const Check& check : checks)
    json["checks"].push_back({{"name", check.name},
                              {"verdict", WordOf(check.verdict)},
                              {"figure", check.figure},
                              {"advice", check.advice}});
  // Whatever bytes a device's words hold.
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

std::string ChecksJunit(const std::vector<Check>& checks) {
  std::vector<JunitCase> cases;
  for (const Check& check : checks) {
    const auto outcome = check.verdict == Verdict::kFailed    ? JunitOutcome::kFailed
                         : check.verdict == Verdict::kSkipped ? JunitOutcome::kSkipped
                                                              : JunitOutcome::kPassed;
    const std::string warning = check.verdict == Verdict::kWarning ? "warning: " : "";
    cases.push_back({"doctor", check.name, outcome,
                     warning + check.figure + (check.advice.empty() ? "" : " -> " + check.advice)});
  }
  return JunitXml("turnlight doctor", cases);
}

bool AnyFailed(const std::vector<Check>& checks) { return CountOf(checks, Verdict::kFailed) > 0; }

}  // namespace turnlight::app
