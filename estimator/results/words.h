// The words that files and options use for what the estimator has as enumerations: one table for
// each kind, which result.json, truth.json, configs, `--model`, `--method` and `render --set`
// share.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/strict_object.h"
#include "estimator/estimate.h"
#include "estimator/model/scene.h"

namespace turnlight::estimator::results {

// How an estimate was made.
enum class Method {
  kLeastSquares,  // over all parameters together, with sigmas: EstimateScene
  kPaper,         // the published method: baseline::EstimateByPaper
};

template <typename Value>
struct Word {
  const char* text;
  Value value;
};

// The table of a kind, in the order in which messages list it.
template <typename Value>
std::span<const Word<Value>> Words() = delete;
template <>
std::span<const Word<model::SpecularModel>> Words();  // none, and every lobe
template <>
std::span<const Word<model::DiffuseModel>> Words();  // every diffuse model
template <>
std::span<const Word<solve::Stopped>>
Words();  // converged, no-descent, iteration-limit, not-finite
template <>
std::span<const Word<Method>> Words();  // lm, paper

template <typename Value>
std::string WordOf(Value value) {
  for (const Word<Value>& word : Words<Value>())
    if (word.value == value) return word.text;
  return "";
}

// Nothing if it is no word of the table.
template <typename Value>
std::optional<Value> ValueOf(std::string_view text) {
  for (const Word<Value>& word : Words<Value>())
    if (word.text == text) return word.value;
  return std::nullopt;
}

template <typename Value>
std::vector<std::string> AllWords() {
  std::vector<std::string> texts;
  for (const Word<Value>& word : Words<Value>()) texts.emplace_back(word.text);
  return texts;
}

// A key of a file that must be one of the words; what it refuses is left in the object, and the
// first of the table returned.
template <typename Value>
Value ReadWord(StrictObject& object, std::string_view key) {
  return ValueOf<Value>(object.Choice(key, AllWords<Value>())).value_or(Words<Value>()[0].value);
}
template <typename Value>
std::optional<Value> ReadOptionalWord(StrictObject& object, std::string_view key) {
  const auto text = object.OptionalChoice(key, AllWords<Value>());
  return text ? ValueOf<Value>(*text) : std::nullopt;
}

}  // namespace turnlight::estimator::results
