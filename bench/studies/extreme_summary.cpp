#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "base/format.h"
#include "bench/studies/summary_parts.h"

namespace turnlight::studies {
namespace {

constexpr double kMostSigmas = 4.0;

// The quantity with the largest error in sigmas.
const Quantity* Worst(const std::vector<Quantity>& quantities) {
  const auto in_sigmas = [](const Quantity& q) { return q.ErrorInSigmas().value_or(INFINITY); };
  const auto worst = std::max_element(
      quantities.begin(), quantities.end(),
      [&](const Quantity& a, const Quantity& b) { return in_sigmas(a) < in_sigmas(b); });
  return worst == quantities.end() ? nullptr : &*worst;
}

double DirectionSigma(const Json& record) {
  for (const Quantity& quantity : Quantities(record))
    if (quantity.name == "direction" && quantity.light == 0)
      return quantity.sigma.value_or(INFINITY);
  return INFINITY;
}

constexpr double kLeastSigmaShare = 0.8;  // of one view's; its noise is another

const Json* FindCell(const StudyFile& file, const std::string& setting) {
  for (const auto& [id, record] : file.records)
    if (record.value("group", std::string()).starts_with("views") && record["setting"] == setting &&
        record.contains("quantities"))
      return &record;
  return nullptr;
}

// Identical views are one view: the note says so, and the sigmas are those of one.
void CheckIdenticalViews(const StudyFile& file, Summary& out) {
  for (const auto& [one, many] :
       {std::pair("1", "36 identical"), std::pair("1, no noise", "36 identical, no noise")}) {
    const Json* single = FindCell(file, one);
    const Json* identical = FindCell(file, many);
    if (!single || !identical) continue;
    const Json& notes = (*identical)["notes"];
    const bool said = std::find(notes.begin(), notes.end(), "views-add-nothing") != notes.end();
    const double ratio = DirectionSigma(*identical) / DirectionSigma(*single);
    const int distinct = (*identical)["distinct_views"];
    Accept(out, std::string("one view: ") + many,
           said && distinct == 1 && ratio >= kLeastSigmaShare ? 1 : 0, 1, 1.0);
    out.text += Format("         distinct_views %d, note %s, direction sigma %.3g of one view's\n",
                       distinct, said ? "there" : "missing", ratio);
  }
}

}  // namespace

Summary SummariseExtremes(const StudyFile& file) {
  Summary out;
  std::size_t answered = 0, finite = 0, honest = 0, compared = 0;
  std::string bad;
  for (const auto& [id, record] : file.records) {
    if (record.contains("failed")) {
      bad += "    " + id + ": " + record["failed"].get<std::string>() + "\n";
      continue;
    }
    ++answered;
    if (record.contains("refused")) {
      ++finite;
      continue;
    }
    if (record["nan"].get<bool>()) {
      bad += "    " + id + ": a number is missing that must be there\n";
      continue;
    }
    ++finite;
    ++compared;
    const auto quantities = Quantities(record);
    const Quantity* worst = Worst(quantities);
    const double sigmas = worst ? worst->ErrorInSigmas().value_or(INFINITY) : 0.0;
    honest += sigmas <= kMostSigmas ? 1 : 0;
    if (sigmas > kMostSigmas)
      bad += Format(
          "    %s: %s of light %d is %.4g, true %.4g, sigma %.2g: %.3g sigma; %d of %d "
          "lights\n",
          id.c_str(), worst->name.c_str(), worst->light, worst->value, worst->truth,
          worst->sigma.value_or(INFINITY), sigmas, record["lights_found"].get<int>(),
          record["lights_true"].get<int>());
  }
  Accept(out, "answered: no crash, no hang", answered, file.records.size(), 1.0);
  Accept(out, "every number that must be there is finite", finite, answered, 1.0);
  Accept(out, "no error above 4 sigma_total", honest, compared, 1.0);
  CheckIdenticalViews(file, out);
  out.text += "  cells that fail:\n" + bad;
  return out;
}

}  // namespace turnlight::studies
