// Are two things the same? Quantities of the two side by side, each with its difference, how much
// of it is allowed, and a verdict.
//
// A quantity has two limits: its difference in sigmas, |a - b| / sqrt(sigma_a^2 + sigma_b^2), where
// both sides have a sigma, and a stated tolerance, the larger of an absolute one and a relative
// share of the larger of |a| and |b|. Whichever of the two there are count:
//   require: either   the same if within one of them (the default)
//   require: both     the same only if within all of them
// A quantity with neither is the same only if it is equal. Not known (null) on both sides is equal,
// on one side only it is different.
#pragma once

#include <cstddef>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "base/strict_object.h"

namespace turnlight {

enum class Verdict { kSame, kDifferent, kNotJudged };

struct ComparedQuantity {
  std::string group{};     // "light 1", "frame 3 (30.0 deg)"
  std::string quantity{};  // its word in a tolerance file, such as "albedo"; "" if it must be equal
  std::string name{};      // "albedo, red"
  nlohmann::json a = nullptr, b = nullptr;  // numbers, words, lists; null: not known
  std::optional<double> difference{};       // at least 0, in the quantity's unit
  std::optional<double> sigmas{};           // the difference in sigmas
  std::optional<double> sigmas_limit{};     // allowed of it; nothing if there are no sigmas
  std::optional<double> allowed{};          // of the difference, by the stated tolerance
  bool both = false;                        // both limits have to be kept
  Verdict verdict = Verdict::kSame;
  std::string why{};     // of what is different or not judged, for people
  std::string remark{};  // what else people should know of it if it is different
};

struct Comparison {
  std::string what;  // "results", "sessions"
  std::vector<ComparedQuantity> quantities;
  std::string content_sha256;  // of both, if they are the same bytes and nothing was measured
  bool Same() const;           // no quantity is different
};

// What is allowed of one quantity.
struct Tolerance {
  std::optional<double> absolute{};  // in the quantity's unit
  std::optional<double> relative{};  // share of the larger of |a| and |b|
  std::optional<double> sigmas{};
  std::optional<bool> both{};
};

struct Tolerances {
  double sigmas = 3.0;
  bool both = false;
  std::map<std::string, Tolerance> quantities;

  // The quantity's own words, and the common ones where it has none.
  Tolerance Of(const std::string& quantity) const;
};

// A quantity that a tolerance file may name, and what is allowed of it without one.
struct QuantityWord {
  std::string word;
  Tolerance standard;
};

// The standard tolerances of the words.
Tolerances StandardTolerances(const std::vector<QuantityWord>& words);

// A section of a tolerance file:
//   {sigmas: 3, require: either|both, WORD: {absolute: A, relative: R, sigmas: S, require: ...}}
// every key optional, with the words' standards for those that are not named; a word that is named
// states all of its tolerance. Refused (kInput): other keys, numbers below 0, a word without
// limits.
Result<Tolerances> ReadTolerances(StrictObject object, const std::vector<QuantityWord>& words);

// One side of a quantity.
struct MeasuredValue {
  std::optional<double> value;
  std::optional<double> sigma;
};

// Fills in difference, limits and verdict of a quantity whose difference, at least 0, was measured.
// sigmas: what it is in sigmas, if they are known. size: what a relative tolerance is a share of.
void Judge(double difference, std::optional<double> sigmas, double size, const Tolerance& tolerance,
           ComparedQuantity& quantity);

// A difference in sigmas; nothing if one of the sigmas is not known or both are 0.
std::optional<double> InSigmas(double difference, const std::optional<double>& sigma_a,
                               const std::optional<double>& sigma_b);

// quantity has its group, word and name; a and b are filled in.
ComparedQuantity CompareNumbers(ComparedQuantity quantity, const MeasuredValue& a,
                                const MeasuredValue& b, const Tolerances& tolerances);
// What must be equal: words, lists, numbers without a tolerance.
ComparedQuantity CompareEqual(std::string group, std::string name, nlohmann::json a,
                              nlohmann::json b);

// The chance that the largest of `count` independent normal values exceeds so many sigmas.
double ChanceOfLargest(double sigmas, std::size_t count);
// The limit for the largest of `count` independent normal values, at least 1, which chance exceeds
// as rarely as it exceeds `sigmas`, 0 to 30, by a single one.
double LimitOfLargest(double sigmas, std::size_t count);

}  // namespace turnlight
