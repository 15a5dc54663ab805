#include "base/comparison.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/format.h"

namespace turnlight {
namespace {

constexpr int kDigits = 4;  // of numbers in messages
constexpr double kMaxSigmas = 1e6;
constexpr double kMaxTolerance = 1e12;

const std::vector<std::string> kRequired{"either", "both"};

std::optional<bool> ReadRequire(StrictObject& object) {
  const auto word = object.OptionalChoice("require", kRequired);
  return word ? std::optional(*word == kRequired[1]) : std::nullopt;
}

Result<Tolerance> ReadTolerance(StrictObject object) {
  Tolerance tolerance;
  tolerance.absolute = object.OptionalNumber("absolute", {.min = 0.0, .max = kMaxTolerance});
  tolerance.relative = object.OptionalNumber("relative", {.min = 0.0, .max = kMaxTolerance});
  tolerance.sigmas = object.OptionalNumber("sigmas", {.min = 0.0, .max = kMaxSigmas});
  tolerance.both = ReadRequire(object);
  if (Status status = object.Finish(); !status) return Forward(status);
  if (tolerance.absolute || tolerance.relative || tolerance.sigmas) return tolerance;
  object.RefuseText(
      "absolute", "none of absolute, relative and sigmas is given, allowed is one of them or more");
  return Forward(object.Finish());
}

std::string WhyDifferent(const ComparedQuantity& quantity) {
  std::string text = "differ by " + NumberText(*quantity.difference, kDigits);
  if (quantity.sigmas) text += ", " + NumberText(*quantity.sigmas, kDigits) + " sigmas";
  std::vector<std::string> limits;
  if (quantity.sigmas_limit)
    limits.push_back(NumberText(*quantity.sigmas_limit, kDigits) + " sigmas");
  if (quantity.allowed) limits.push_back(NumberText(*quantity.allowed, kDigits));
  if (limits.empty())
    return text + "; there is no sigma and no tolerance is stated, so allowed is only the same";
  text += ", allowed is " + limits[0];
  if (limits.size() == 2) text += (quantity.both ? " and " : " or ") + limits[1];
  return text;
}

}  // namespace

bool Comparison::Same() const {
  return std::none_of(quantities.begin(), quantities.end(), [](const ComparedQuantity& quantity) {
    return quantity.verdict == Verdict::kDifferent;
  });
}

Tolerance Tolerances::Of(const std::string& quantity) const {
  const auto found = quantities.find(quantity);
  Tolerance tolerance = found == quantities.end() ? Tolerance() : found->second;
  if (!tolerance.sigmas) tolerance.sigmas = sigmas;
  if (!tolerance.both) tolerance.both = both;
  return tolerance;
}

Tolerances StandardTolerances(const std::vector<QuantityWord>& words) {
  Tolerances tolerances;
  for (const QuantityWord& word : words) tolerances.quantities[word.word] = word.standard;
  return tolerances;
}

Result<Tolerances> ReadTolerances(StrictObject object, const std::vector<QuantityWord>& words) {
  Tolerances tolerances = StandardTolerances(words);
  tolerances.sigmas =
      object.OptionalNumber("sigmas", {.min = 0.0, .max = kMaxSigmas}).value_or(tolerances.sigmas);
  tolerances.both = ReadRequire(object).value_or(tolerances.both);
  for (const QuantityWord& word : words) {
    auto named = object.OptionalObject(word.word);
    if (!named || !object.ok()) continue;
    const auto tolerance = ReadTolerance(std::move(*named));
    if (!tolerance) return Forward(tolerance);
    tolerances.quantities[word.word] = *tolerance;
  }
  if (Status status = object.Finish(); !status) return Forward(status);
  return tolerances;
}

void Judge(double difference, std::optional<double> sigmas, double size, const Tolerance& tolerance,
           ComparedQuantity& quantity) {
  quantity.difference = difference;
  quantity.both = tolerance.both.value_or(false);
  std::vector<bool> within;
  if (sigmas && tolerance.sigmas) {
    quantity.sigmas = sigmas;
    quantity.sigmas_limit = tolerance.sigmas;
    within.push_back(*quantity.sigmas <= *quantity.sigmas_limit);
  }
  if (tolerance.absolute || tolerance.relative) {
    quantity.allowed =
        std::max(tolerance.absolute.value_or(0.0), tolerance.relative.value_or(0.0) * size);
    within.push_back(difference <= *quantity.allowed);
  }
  const auto kept = static_cast<std::size_t>(std::count(within.begin(), within.end(), true));
  // Not a number is within nothing.
  const bool same =
      difference == 0.0 || (quantity.both ? !within.empty() && kept == within.size() : kept > 0);
  quantity.verdict = same ? Verdict::kSame : Verdict::kDifferent;
  if (!same) quantity.why = WhyDifferent(quantity);
}

std::optional<double> InSigmas(double difference, const std::optional<double>& sigma_a,
                               const std::optional<double>& sigma_b) {
  if (!sigma_a || !sigma_b) return std::nullopt;
  const double sigma = std::hypot(*sigma_a, *sigma_b);
  return sigma > 0.0 ? std::optional(difference / sigma) : std::nullopt;
}

ComparedQuantity CompareNumbers(ComparedQuantity quantity, const MeasuredValue& a,
                                const MeasuredValue& b, const Tolerances& tolerances) {
  const auto to_json = [](const std::optional<double>& value) {
    return value ? nlohmann::json(*value) : nlohmann::json();
  };
  quantity.a = to_json(a.value);
  quantity.b = to_json(b.value);
  if (!a.value || !b.value) {
    if (!a.value && !b.value) return quantity;
    quantity.verdict = Verdict::kDifferent;
    quantity.why = std::string("not known in ") + (a.value ? "B" : "A") + ", known in " +
                   (a.value ? "A" : "B");
    return quantity;
  }
  const double difference = std::abs(*a.value - *b.value);
  Judge(difference, InSigmas(difference, a.sigma, b.sigma),
        std::max(std::abs(*a.value), std::abs(*b.value)), tolerances.Of(quantity.quantity),
        quantity);
  return quantity;
}

ComparedQuantity CompareEqual(std::string group, std::string name, nlohmann::json a,
                              nlohmann::json b) {
  ComparedQuantity quantity{.group = std::move(group), .name = std::move(name)};
  if (a != b) {
    quantity.verdict = Verdict::kDifferent;
    quantity.why = "allowed is only the same";
  }
  quantity.a = std::move(a);
  quantity.b = std::move(b);
  return quantity;
}

double ChanceOfLargest(double sigmas, std::size_t count) {
  const double of_one = std::erfc(sigmas / std::sqrt(2.0));
  // 1 - (1 - p)^count, exact for a small p.
  return -std::expm1(static_cast<double>(count) * std::log1p(-std::min(of_one, 1.0)));
}

double LimitOfLargest(double sigmas, std::size_t count) {
  constexpr int kHalvings = 60;  // of the interval, to the last bits
  const double chance = std::erfc(sigmas / std::sqrt(2.0));
  double low = sigmas;
  double high = sigmas + 40.0;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (ChanceOfLargest(middle, count) > chance ? low : high) = middle;
  }
  return high;
}

}  // namespace turnlight
