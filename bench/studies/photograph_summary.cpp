#include "bench/studies/photograph_summary.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/format.h"
#include "base/statistics.h"
#include "bench/studies/statistics.h"
#include "bench/studies/summary_parts.h"

namespace turnlight::studies {
namespace {

// How far the true directions are off themselves, in degrees: those of the glossy ball's lights
// come from another, mirroring ball, those of the gray ball's from a chrome ball's highlight.
constexpr double kBallTruthDeg = 0.4, kGrayTruthDeg = 1.0;
constexpr const char* kSets[] = {"ball-1", "ball-2", "ball-3", "ball-4", "gray-1", "gray-2"};

std::string SetOf(const std::string& id) { return id.substr(0, id.find('/')); }
std::string MethodOf(const std::string& id) { return id.substr(id.rfind('/') + 1); }
std::size_t LightsOf(const std::string& set) { return std::stoul(set.substr(set.rfind('-') + 1)); }
double TruthDeg(const std::string& id) {
  return id.starts_with("gray") ? kGrayTruthDeg : kBallTruthDeg;
}

std::string WordsOfSet(const std::string& set) {
  const std::string ball = set.starts_with("gray") ? "gray ball" : "glossy ball";
  const std::size_t lights = LightsOf(set);
  return ball + ", " + std::to_string(lights) + (lights == 1 ? " light" : " lights");
}

// What a method gave on some sets.
struct Tally {
  std::size_t attempted = 0, refused = 0, right = 0;
  std::size_t right_warned = 0, wrong_warned = 0;  // by count-uncertain
  std::vector<double> errors;                      // of the lights that were found, degrees
  std::vector<double> sigmas;  // stated for them, where the method states sigmas; infinite if null
  std::vector<double> in_sigmas;  // errors, in sigmas with the truth's own error added
  std::vector<double> seconds;    // of processor time, of each answer

  std::size_t wrong() const { return attempted - refused - right; }
};

void Add(const Json& record, Tally& tally) {
  const std::string id = record["id"];
  ++tally.attempted;
  if (record.contains("failed")) {
    ++tally.refused;
    return;
  }
  tally.seconds.push_back(record.value("cpu_s", 0.0));
  if (Right(record)) {
    ++tally.right;
    tally.right_warned += WarnedOfCount(record) ? 1 : 0;
  } else {
    tally.wrong_warned += WarnedOfCount(record) ? 1 : 0;
  }
  for (const Json& angle : record["angles_deg"])
    if (angle.is_number()) tally.errors.push_back(angle.get<double>());
  if (MethodOf(id) == "script") return;
  for (const Quantity& quantity : Quantities(record)) {
    if (quantity.name != "direction") continue;
    const double sigma = quantity.sigma.value_or(INFINITY);
    tally.sigmas.push_back(sigma);
    tally.in_sigmas.push_back(quantity.sigma ? quantity.Error() / std::hypot(sigma, TruthDeg(id))
                                             : INFINITY);
  }
}

Tally TallyOf(const StudyFile& file, const std::string& sets, const std::string& method) {
  Tally tally;
  for (const auto& [id, record] : file.records)
    if (id.starts_with(sets) && MethodOf(id) == method) Add(record, tally);
  return tally;
}

Tally Joined(Tally a, const Tally& b) {
  a.attempted += b.attempted;
  a.refused += b.refused;
  a.right += b.right;
  a.right_warned += b.right_warned;
  a.wrong_warned += b.wrong_warned;
  a.errors.insert(a.errors.end(), b.errors.begin(), b.errors.end());
  a.sigmas.insert(a.sigmas.end(), b.sigmas.begin(), b.sigmas.end());
  a.in_sigmas.insert(a.in_sigmas.end(), b.in_sigmas.begin(), b.in_sigmas.end());
  a.seconds.insert(a.seconds.end(), b.seconds.begin(), b.seconds.end());
  return a;
}

double Mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

std::size_t Within(const std::vector<double>& in_sigmas, double limit) {
  return static_cast<std::size_t>(
      std::count_if(in_sigmas.begin(), in_sigmas.end(), [&](double z) { return z <= limit; }));
}

double Percent(std::size_t part, std::size_t all) {
  return 100.0 * static_cast<double>(part) / static_cast<double>(all);
}

void AcceptErrors(Summary& out, const std::string& what, const Tally& tally, double mean,
                  double worst) {
  if (tally.errors.empty()) return;
  AcceptAtMost(out, what + ": mean direction", Mean(tally.errors), mean, "deg");
  AcceptAtMost(out, what + ": worst direction", InterpolatedQuantile(tally.errors, 1.0), worst,
               "deg");
}

void AcceptBall(Summary& out, const Tally& singles, const Tally& sums) {
  constexpr double kSeconds = 1.5;
  Accept(out, "glossy ball, 1 light: count", singles.right, singles.attempted, 0.97);
  AcceptErrors(out, "glossy ball, 1 light", singles, 0.40, 1.1);
  if (!singles.seconds.empty())
    AcceptAtMost(out, "glossy ball, 1 light: median processor time",
                 InterpolatedQuantile(singles.seconds, 0.5), kSeconds, "s");
  Accept(out, "glossy ball, sums: count", sums.right, sums.attempted, 0.97);
  AcceptErrors(out, "glossy ball, sums", sums, 0.45, 1.3);
  const Tally all = Joined(singles, sums);
  Accept(out, "glossy ball: not refused", all.attempted - all.refused, all.attempted, 1.0);
  if (all.sigmas.empty()) return;
  AcceptAtMost(out, "glossy ball: median sigma", InterpolatedQuantile(all.sigmas, 0.5),
               std::max(2.0 * InterpolatedQuantile(all.errors, 0.5), kBallTruthDeg), "deg");
  const std::size_t one = Within(all.in_sigmas, 1.0);
  Accept(out, "glossy ball: within 1 sigma", one, all.in_sigmas.size(), 0.60);
  AcceptAtMost(out, "glossy ball: within 1 sigma, not too many", Percent(one, all.in_sigmas.size()),
               85.0, "%");
  Accept(out, "glossy ball: within 2 sigma", Within(all.in_sigmas, 2.0), all.in_sigmas.size(),
         0.90);
}

void AcceptGray(Summary& out, const Tally& singles, const Tally& sums) {
  AcceptErrors(out, "gray ball, 1 light", singles, 1.6, 3.1);
  if (!singles.sigmas.empty())
    AcceptAtMost(out, "gray ball, 1 light: median sigma", InterpolatedQuantile(singles.sigmas, 0.5),
                 4.0, "deg");
  Accept(out, "gray ball, 1 light: within 2 sigma", Within(singles.in_sigmas, 2.0),
         singles.in_sigmas.size(), 1.0);
  Accept(out, "gray ball, 2 lights: two, or a note", sums.right + sums.wrong_warned,
         sums.attempted - sums.refused, 1.0);
  Accept(out, "gray ball, 2 lights: within 3 sigma", Within(sums.in_sigmas, 3.0),
         sums.in_sigmas.size(), 1.0);
}

void AcceptNotes(Summary& out, const Tally& all) {
  if (all.right > 0)
    AcceptAtMost(out, "count-uncertain in right answers", Percent(all.right_warned, all.right),
                 20.0, "%");
  Accept(out, "count-uncertain in wrong answers", all.wrong_warned, all.wrong(), 0.5);
}

std::string Row(const std::string& set, const std::string& method, const Tally& tally) {
  std::string text = Format("  %-21s %-18s %2zu of %-3zu", set.c_str(), method.c_str(), tally.right,
                            tally.attempted);
  const auto number = [&](double value) {
    text += std::isfinite(value) ? Format(" %7.2f", value) : Format(" %7s", "-");
  };
  number(Mean(tally.errors));
  number(InterpolatedQuantile(tally.errors, 0.5));
  number(InterpolatedQuantile(tally.errors, 1.0));
  number(InterpolatedQuantile(tally.sigmas, 0.5));
  for (const double limit : {1.0, 2.0}) {
    const bool states = std::isfinite(InterpolatedQuantile(tally.sigmas, 0.0));
    text += states
                ? Format(" %5.0f", Percent(Within(tally.in_sigmas, limit), tally.in_sigmas.size()))
                : Format(" %5s", "-");
  }
  number(InterpolatedQuantile(tally.seconds, 0.5));
  return text + "\n";
}

std::string NotRight(const StudyFile& file) {
  std::string list;
  for (const auto& [id, record] : file.records) {
    if (MethodOf(id) != "turnlight") continue;
    if (record.contains("failed"))
      list += "    " + id + ": " + record["failed"].get<std::string>() + "\n";
    else if (!Right(record))
      list += "    " + id + ": " + record.value("say", std::string()) +
              (WarnedOfCount(record) ? ", warned\n" : "\n");
  }
  return list;
}

}  // namespace

std::string WordsOfMethod(const std::string& method) {
  if (method == "paper") return "the paper's method";
  return method == "script" ? "highlight script" : method;
}

Summary SummarisePhotographs(const StudyFile& file) {
  Summary out;
  const auto of = [&](const std::string& sets) { return TallyOf(file, sets, "turnlight"); };
  const Tally ball_sums = Joined(Joined(of("ball-2"), of("ball-3")), of("ball-4"));
  AcceptBall(out, of("ball-1"), ball_sums);
  AcceptGray(out, of("gray-1"), of("gray-2"));
  AcceptNotes(out, of(""));
  out.text +=
      "\n  errors of the lights that were found and the median stated sigma, in degrees; % within "
      "1 and 2\n  sigma to which the truth's own error is added (0.4 degrees, gray ball 1.0); "
      "median "
      "processor time\n  of an answer, seconds (the script's is mostly the start of python)\n";
  out.text += Format("  %-21s %-18s %9s %7s %7s %7s %7s %5s %5s %7s\n", "photographs", "method",
                     "right", "mean", "median", "worst", "sigma", "1", "2", "time");
  for (const char* set : kSets)
    for (const char* method : kPhotographMethods) {
      const Tally tally = TallyOf(file, std::string(set) + "/", method);
      if (tally.attempted > 0) out.text += Row(WordsOfSet(set), WordsOfMethod(method), tally);
    }
  const std::string list = NotRight(file);
  if (!list.empty()) out.text += "\n  turnlight, refused or wrong:\n" + list;
  return out;
}

std::vector<double> PhotographErrors(const StudyFile& file, const std::string& sets,
                                     const std::string& method) {
  std::vector<double> errors;
  for (const auto& [id, record] : file.records) {
    if (!id.starts_with(sets) || MethodOf(id) != method) continue;
    std::vector<double> angles(LightsOf(SetOf(id)), INFINITY);
    if (!record.contains("failed") && Right(record))
      for (std::size_t i = 0; i < angles.size(); ++i)
        if (record["angles_deg"][i].is_number()) angles[i] = record["angles_deg"][i].get<double>();
    errors.insert(errors.end(), angles.begin(), angles.end());
  }
  return errors;
}

}  // namespace turnlight::studies
