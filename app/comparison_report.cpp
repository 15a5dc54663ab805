#include "app/comparison_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/document.h"
#include "base/format.h"

namespace turnlight::app {
namespace {

using nlohmann::ordered_json;

constexpr int kShownDigits = 6;
constexpr std::size_t kShownRows = 40;  // of a table; --json has all

// How near a quantity is to its limit: 1 is at it. Infinite where only the same is allowed.
double ShareOfLimit(const ComparedQuantity& quantity) {
  const double infinite = std::numeric_limits<double>::infinity();
  const auto share = [infinite](double value, double limit) {
    return value == 0.0 ? 0.0 : limit > 0.0 ? value / limit : infinite;
  };
  if (!quantity.difference) return quantity.verdict == Verdict::kSame ? 0.0 : infinite;
  std::vector<double> shares;
  if (quantity.sigmas && quantity.sigmas_limit)
    shares.push_back(share(*quantity.sigmas, *quantity.sigmas_limit));
  if (quantity.allowed) shares.push_back(share(*quantity.difference, *quantity.allowed));
  if (shares.empty()) return *quantity.difference == 0.0 ? 0.0 : infinite;
  return quantity.both ? *std::max_element(shares.begin(), shares.end())
                       : *std::min_element(shares.begin(), shares.end());
}

std::string ValueText(const nlohmann::json& value) {
  if (value.is_null()) return "-";
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) return NumberText(value.get<double>(), kShownDigits);
  if (!value.is_array()) return ShowValue(value);
  std::vector<std::string> parts;
  for (const auto& part : value) parts.push_back(ValueText(part));
  return "(" + Listed(parts) + ")";
}

// At most so wide; not cut within a character of UTF-8.
std::string Short(const std::string& text) {
  constexpr std::size_t kWidest = 36;
  if (text.size() <= kWidest) return text;
  std::size_t end = kWidest - 3;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;
  return text.substr(0, end) + "...";
}

std::string OptionalText(const std::optional<double>& value, int digits) {
  return value ? NumberText(*value, digits) : "-";
}

std::string LimitText(const ComparedQuantity& quantity) {
  std::vector<std::string> limits;
  if (quantity.sigmas_limit) limits.push_back(NumberText(*quantity.sigmas_limit, 3) + " sigmas");
  if (quantity.allowed) limits.push_back(NumberText(*quantity.allowed, 3));
  if (limits.empty()) return "equal";
  return limits.size() == 1 ? limits[0]
                            : limits[0] + (quantity.both ? " and " : " or ") + limits[1];
}

std::string VerdictText(Verdict verdict) {
  switch (verdict) {
    case Verdict::kSame:
      return "same";
    case Verdict::kDifferent:
      return "different";
    case Verdict::kNotJudged:
      return "not judged";
  }
  return "";
}

std::string NameOf(const ComparedQuantity& quantity) {
  return quantity.group + ": " + quantity.name;
}

using Row = std::array<std::string, 7>;

// Columns as wide as their widest text, two blanks apart.
std::string Aligned(const std::vector<Row>& rows) {
  std::array<std::size_t, 7> widths{};
  for (const Row& row : rows)
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  std::string text;
  for (const Row& row : rows) {
    std::string line = " ";
    for (std::size_t i = 0; i < row.size(); ++i)
      line += " " + row[i] + std::string(widths[i] - row[i].size() + 1, ' ');
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  }
  return text;
}

std::string Table(std::vector<const ComparedQuantity*> quantities) {
  std::stable_sort(quantities.begin(), quantities.end(),
                   [](const ComparedQuantity* a, const ComparedQuantity* b) {
                     return ShareOfLimit(*a) > ShareOfLimit(*b);
                   });
  std::vector<Row> rows{{"what", "A", "B", "difference", "sigmas", "allowed", "verdict"}};
  for (const ComparedQuantity* quantity : quantities) {
    if (rows.size() > kShownRows) break;
    // What the other columns do not say.
    const bool in_numbers = quantity->difference && quantity->verdict == Verdict::kDifferent;
    const std::string& words = in_numbers ? quantity->remark : quantity->why;
    rows.push_back({NameOf(*quantity), Short(ValueText(quantity->a)), Short(ValueText(quantity->b)),
                    OptionalText(quantity->difference, 3), OptionalText(quantity->sigmas, 3),
                    LimitText(*quantity),
                    VerdictText(quantity->verdict) + (words.empty() ? "" : ": " + words)});
  }
  const std::size_t shown = rows.size() - 1;
  std::string text = Aligned(rows);
  if (shown < quantities.size())
    text += "  and " + std::to_string(quantities.size() - shown) + " more; --json has all\n";
  return text;
}

std::vector<const ComparedQuantity*> WithVerdict(const Comparison& comparison, Verdict verdict) {
  std::vector<const ComparedQuantity*> found;
  for (const ComparedQuantity& quantity : comparison.quantities)
    if (quantity.verdict == verdict) found.push_back(&quantity);
  return found;
}

// "; nearest to its limit is light 2: distance, 2.1 of 3 sigmas"
std::string NearestToLimit(const Comparison& comparison) {
  const auto nearest =
      std::max_element(comparison.quantities.begin(), comparison.quantities.end(),
                       [](const ComparedQuantity& a, const ComparedQuantity& b) {
                         return (a.verdict == Verdict::kSame ? ShareOfLimit(a) : -1.0) <
                                (b.verdict == Verdict::kSame ? ShareOfLimit(b) : -1.0);
                       });
  if (nearest == comparison.quantities.end() || ShareOfLimit(*nearest) == 0.0) return ", all equal";
  const std::string text = "; nearest to its limit is " + NameOf(*nearest) + ", ";
  if (!nearest->sigmas)
    return text + NumberText(*nearest->difference, 3) + " of " + LimitText(*nearest);
  return text + NumberText(*nearest->sigmas, 3) + " sigmas of " + LimitText(*nearest);
}

ordered_json OrNull(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? ordered_json(*value) : ordered_json();
}

ordered_json ToJson(const ComparedQuantity& quantity) {
  return {
      {"group", quantity.group},
      {"name", quantity.name},
      {"quantity", quantity.quantity.empty() ? ordered_json() : ordered_json(quantity.quantity)},
      {"a", quantity.a},
      {"b", quantity.b},
      {"difference", OrNull(quantity.difference)},
      {"sigmas", OrNull(quantity.sigmas)},
      {"sigmas_limit", OrNull(quantity.sigmas_limit)},
      {"allowed", OrNull(quantity.allowed)},
      {"require", quantity.both ? "both" : "either"},
      {"verdict", VerdictText(quantity.verdict)},
      {"why", quantity.why},
      {"remark", quantity.verdict == Verdict::kDifferent ? quantity.remark : ""}};
}

}  // namespace

std::string ComparisonText(const Comparison& comparison) {
  if (!comparison.content_sha256.empty())
    return comparison.what + ": identical, content sha256 " + comparison.content_sha256 + "\n";
  const auto different = WithVerdict(comparison, Verdict::kDifferent);
  auto shown = different;
  const auto not_judged = WithVerdict(comparison, Verdict::kNotJudged);
  shown.insert(shown.end(), not_judged.begin(), not_judged.end());
  const std::string count = std::to_string(comparison.quantities.size());
  std::string text =
      comparison.what +
      (different.empty()
           ? ": the same, " + count + " quantities" + NearestToLimit(comparison)
           : ": different, " + std::to_string(different.size()) + " of " + count + " quantities") +
      "\n";
  if (!shown.empty()) text += Table(shown);
  return text;
}

std::string ComparisonsToJson(const std::string& a, const std::string& b,
                              const std::vector<Comparison>& comparisons) {
  ordered_json json{{"format", "turnlight-comparison"}, {"version", 1}, {"a", a}, {"b", b}};
  json["same"] = std::all_of(comparisons.begin(), comparisons.end(),
                             [](const Comparison& comparison) { return comparison.Same(); });
  json["comparisons"] = ordered_json::array();
  for (const Comparison& comparison : comparisons) {
    ordered_json one{{"what", comparison.what}, {"same", comparison.Same()}};
    one["content_sha256"] = nullptr;
    if (!comparison.content_sha256.empty()) one["content_sha256"] = comparison.content_sha256;
    one["quantities"] = ordered_json::array();
    for (const ComparedQuantity& quantity : comparison.quantities)
      one["quantities"].push_back(ToJson(quantity));
    json["comparisons"].push_back(std::move(one));
  }
  return json.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

std::vector<JunitCase> JunitCases(const std::vector<Comparison>& comparisons) {
  std::vector<JunitCase> cases;
  for (const Comparison& comparison : comparisons) {
    if (!comparison.content_sha256.empty())
      cases.push_back({comparison.what, "content", JunitOutcome::kPassed,
                       "identical, content sha256 " + comparison.content_sha256});
    for (const ComparedQuantity& quantity : comparison.quantities) {
      JunitCase test{comparison.what + "." + quantity.group, quantity.name, JunitOutcome::kPassed,
                     ""};
      if (quantity.verdict == Verdict::kDifferent) test.outcome = JunitOutcome::kFailed;
      if (quantity.verdict == Verdict::kNotJudged) test.outcome = JunitOutcome::kSkipped;
      if (quantity.verdict != Verdict::kSame)
        test.text = "A " + ValueText(quantity.a) + ", B " + ValueText(quantity.b) + ": " +
                    quantity.why + (quantity.remark.empty() ? "" : "; " + quantity.remark);
      cases.push_back(std::move(test));
    }
  }
  return cases;
}

}  // namespace turnlight::app
