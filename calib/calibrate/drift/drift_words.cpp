#include "calib/calibrate/drift/drift_words.h"

#include <algorithm>
#include <cmath>

#include "base/format.h"

namespace turnlight::calib::calibrate::drift {
namespace {

constexpr double kNamed = 3.0;  // sigmas from which a quantity is worth a word
constexpr std::size_t kViewsNamed = 6;
constexpr double kLeastChance = 1e-12;  // smaller ones are a matter of words

double SigmasOf(const Quantity& quantity) { return std::abs(quantity.value) / quantity.sigma; }

// "0.050 +- 0.003 deg", the value to the sigma's second digit.
std::string ValueText(const Quantity& quantity) {
  const int decimals =
      std::clamp(1 - static_cast<int>(std::floor(std::log10(quantity.sigma))), 0, 9);
  return Format("%.*f +- %.*f %s", decimals, quantity.value, decimals, quantity.sigma,
                quantity.unit.c_str());
}

std::string Named(const Finding& finding) {
  std::string names;
  for (const Cause cause : finding.causes)
    names += (names.empty() ? "" : " and ") + CauseName(cause);
  return names;
}

// What stands out, at least one.
std::string Standing(const Finding& finding) {
  double most = 0.0;
  for (const Quantity& quantity : finding.quantities) most = std::max(most, SigmasOf(quantity));
  std::string text;
  for (const Quantity& quantity : finding.quantities) {
    const double sigmas = SigmasOf(quantity);
    if (sigmas < std::min(kNamed, most)) continue;
    text += (text.empty() ? "" : ", ") + quantity.words + " " + ValueText(quantity) +
            Format(" (%.*f sigmas)", sigmas < 10.0 ? 1 : 0, sigmas);
  }
  return text;
}

std::string ChanceText(double chance) {
  return chance < kLeastChance ? Format("chance below %.0g", kLeastChance)
                               : Format("chance %.1g", chance);
}

// What one cause alone would be.
std::string AloneText(const Finding& finding) {
  std::string text =
      Format("%-13s %s%s\n", ("only " + Named(finding)).c_str(), ChanceText(finding.chance).c_str(),
             finding.explains ? "" : "; leaves much unexplained");
  for (const Quantity& quantity : finding.quantities)
    text += Format("%-13s %s %s\n", "", quantity.words.c_str(), ValueText(quantity).c_str());
  return text;
}

// The smallest drift that would have stood out.
std::string WouldBeSeen(const DriftReport& report) {
  std::string text;
  for (const Finding& finding : report.alone)
    for (const Quantity& quantity : finding.quantities)
      if (finding.causes.front() != Cause::kCamera || quantity.key.starts_with("axis"))
        text += Format("%s%s %.2g %s", text.empty() ? "" : ", ", quantity.words.c_str(),
                       kNamed * quantity.sigma, quantity.unit.c_str());
  return text;
}

std::string DriftedText(const DriftReport& report) {
  const bool all = report.found.causes.size() > 2;
  std::string text = "drifted: ";
  if (report.found.causes.size() > 1)
    text += (all ? "more than two things at once, "
                 : Named(report.found) + ", as one alone does not explain it: ");
  text += Standing(report.found);
  for (const Finding& other : report.as_well)
    text += "; as well it may be the " + Named(other) + ": " + Standing(other);
  return text;
}

}  // namespace

std::string VerdictWord(Verdict verdict) {
  switch (verdict) {
    case Verdict::kStillTrue:
      return "still true";
    case Verdict::kDrifted:
      return "drifted";
    case Verdict::kCannotTell:
      return "cannot tell";
  }
  return "";
}

std::string DriftVerdict(const DriftReport& report) {
  if (report.verdict == Verdict::kCannotTell) return "cannot tell: " + report.why;
  if (report.verdict == Verdict::kDrifted) return DriftedText(report);
  return Format(
             "still true: the pictures fit the stored calibration within its sigmas and theirs "
             "(chance %.2g). One cause alone would have stood out (3 sigmas) from: ",
             report.everything.chance) +
         WouldBeSeen(report);
}

std::vector<std::string> Remedies(const DriftReport& report) {
  if (report.verdict != Verdict::kDrifted) return {};
  std::vector<Cause> causes = report.found.causes;
  const auto has = [&causes](Cause cause) {
    return std::find(causes.begin(), causes.end(), cause) != causes.end();
  };
  std::vector<std::string> remedies;
  if (has(Cause::kLens))
    remedies.push_back("turnlight calibrate intrinsics: the lens, before the next");
  if (has(Cause::kLens) || has(Cause::kCamera) || has(Cause::kAngles))
    remedies.push_back(has(Cause::kAngles) && causes.size() == 1
                           ? "home the table and check again; if it stays, turnlight calibrate axis"
                           : "turnlight calibrate axis: camera, axis and angles");
  remedies.push_back("turnlight calibrate target: where the target stands");
  return remedies;
}

std::string DriftText(const DriftReport& report) {
  std::string text;
  const auto line = [&text](const std::string& head, const std::string& words) {
    text += Format("%-13s ", head.c_str()) + words + "\n";
  };
  std::vector<std::string> named(
      report.views.begin(), report.views.begin() + static_cast<std::ptrdiff_t>(
                                                       std::min(report.views.size(), kViewsNamed)));
  if (report.views.size() > kViewsNamed) named.push_back("...");
  line("pictures", Format("%zu used: ", report.views.size()) + Listed(named) +
                       Format("; %zu points, %zu outliers", report.points.size(), report.outliers));
  for (const std::string& left : report.left_out) line("left out", left);
  if (!report.alone.empty())
    line("pixels", Format("rms %.3f with the stored calibration, worst %.2f; %.3f of it is noise",
                          report.stored_rms, report.worst, report.noise));
  for (const Finding& finding : report.alone) text += AloneText(finding);
  for (const std::string& remark : report.remarks) line("note", remark);
  line("verdict", DriftVerdict(report));
  for (const std::string& remedy : Remedies(report)) line("to do", remedy);
  return text;
}

}  // namespace turnlight::calib::calibrate::drift
