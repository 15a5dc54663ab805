#include <algorithm>
#include <map>
#include <string>

#include "base/format.h"
#include "bench/studies/summary_parts.h"

namespace turnlight::studies {
namespace {

constexpr double kMostWarnedOfRight = 0.2, kLeastWarnedOfWrong = 0.5;

// How many counts are right and wrong, and of how many the result warns.
struct Warnings {
  std::size_t right = 0, right_warned = 0, wrong = 0, wrong_warned = 0;

  void Add(const Json& record) {
    const std::size_t warned = WarnedOfCount(record) ? 1 : 0;
    (Right(record) ? right : wrong) += 1;
    (Right(record) ? right_warned : wrong_warned) += warned;
  }
};

std::string Row(const std::string& name, const Warnings& of) {
  return Format("    %-12s%6zu of %3zu%10zu of %3zu\n", name.c_str(), of.right_warned, of.right,
                of.wrong_warned, of.wrong);
}

}  // namespace

Summary SummariseHard(const StudyFile& file, int worst) {
  Summary out;
  const auto records = Measured(file, out.text);
  Warnings all;
  std::map<std::string, Warnings> kinds;
  for (const Json* record : records) {
    all.Add(*record);
    kinds[record->value("kind", std::string())].Add(*record);
  }
  AcceptAtMost(out, "warned of the count, when it is right",
               100.0 * static_cast<double>(all.right_warned) /
                   static_cast<double>(std::max<std::size_t>(all.right, 1)),
               100.0 * kMostWarnedOfRight, "%");
  Accept(out, "warned of the count, when it is wrong", all.wrong_warned, all.wrong,
         kLeastWarnedOfWrong);
  out.text += "\n    made hard      right, warned      wrong, warned\n";
  for (const auto& [kind, of] : kinds) out.text += Row(kind, of);
  out.text += Row("all", all) + Times(records) + "\n";
  int left = worst;
  for (const Json* record : records)
    if (!Right(*record) && left-- > 0) out.text += SceneLine(*record);
  return out;
}

}  // namespace turnlight::studies
