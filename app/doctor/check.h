// What one check of `turnlight doctor` found.
#pragma once

#include <string>
#include <utility>

namespace turnlight::app {

enum class Verdict { kOk, kWarning, kFailed, kSkipped };

struct Check {
  Verdict verdict = Verdict::kOk;
  std::string figure;  // what was measured, against what is needed; of a skipped one: why
  std::string advice;  // what to do: the line to type or to add; empty if nothing
  std::string name;    // "port permissions"; given by the list of checks
};

inline Check Fine(std::string figure) { return {Verdict::kOk, std::move(figure), "", ""}; }
inline Check Warning(std::string figure, std::string advice) {
  return {Verdict::kWarning, std::move(figure), std::move(advice), ""};
}
inline Check Failed(std::string figure, std::string advice) {
  return {Verdict::kFailed, std::move(figure), std::move(advice), ""};
}
inline Check Skipped(std::string why) { return {Verdict::kSkipped, std::move(why), "", ""}; }

}  // namespace turnlight::app
