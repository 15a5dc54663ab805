#include "estimator/results/model_option.h"

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <vector>

#include "base/format.h"
#include "base/nearest.h"
#include "estimator/results/words.h"

namespace turnlight::estimator::results {
namespace {

using model::ModelChoice;

constexpr int kMostLights = 32;

tl::unexpected<Error> NoSuchWord(const std::string& option, const std::string& word,
                                 const std::vector<std::string>& allowed) {
  return InputError("--model " + option + ": \"" + word + "\", allowed are " + Listed(allowed));
}

template <typename Value>
Status Choose(const std::string& option, const std::string& word, std::optional<Value>& out) {
  const auto value = ValueOf<Value>(word);
  if (!value) return NoSuchWord(option, word, AllWords<Value>());
  out = value;
  return {};
}

// The first word is true.
Status ChooseOf(const std::string& option, const std::string& word,
                const std::vector<std::string>& words, std::optional<bool>& out) {
  if (word != words[0] && word != words[1]) return NoSuchWord(option, word, words);
  out = word == words[0];
  return {};
}

// A count, or which of the lights.
Status ChooseNumber(const std::string& option, const std::string& word, int most,
                    std::optional<int>& out) {
  int count = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), count);
  if (error != std::errc() || end != word.data() + word.size() || count < 1 || count > most)
    return InputError("--model " + option + ": \"" + word +
                      "\", allowed is a whole number from 1 to " + std::to_string(most));
  out = count;
  return {};
}

bool TakeNumber(std::string_view word, double& out) {
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), out);
  return error == std::errc() && end == word.data() + word.size() && std::isfinite(out);
}

// A length, or a range of lengths.
Status ChooseDistance(const std::string& option, const std::string& word, ModelChoice& choice) {
  constexpr double kKnownTo = 1e-3;  // of what is given as one number
  const std::size_t dots = word.find("..");
  const std::string_view first = std::string_view(word).substr(0, dots);
  model::DistanceRange range;
  bool numbers = TakeNumber(first, range.least);
  if (dots == std::string::npos) {
    range.most = range.least * (1.0 + kKnownTo);
    range.least *= 1.0 - kKnownTo;
  } else {
    numbers = numbers && TakeNumber(std::string_view(word).substr(dots + 2), range.most);
  }
  if (!numbers || !(range.least > 0.0 && range.most > range.least))
    return InputError("--model " + option + ": \"" + word +
                      "\", allowed is a length in the session's unit, as 1400, or a range from a "
                      "smaller to a larger one, as 1300..1500");
  choice.distance = range;
  return {};
}

// Distances and whether there are any, in whichever order they are told.
Status ChooseNearness(const std::string& option, bool is_distance, const std::string& word,
                      ModelChoice& choice) {
  ModelChoice chosen = choice;
  const Status status = is_distance ? ChooseDistance(option, word, chosen)
                                    : ChooseOf(option, word, {"near", "distant"}, chosen.near);
  if (!status) return status;
  if (chosen.distance.known() && chosen.near == false)
    return InputError("--model " + option +
                      ": lights at a known distance are not distant; give either distance or "
                      "lights-are=distant");
  if (chosen.distance.known()) chosen.near = true;
  choice = chosen;
  return {};
}

}  // namespace

std::string ModelOptionHelp() {
  const auto list = [](const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : "|") + word;
    return text;
  };
  return "lights=N (1 to " + std::to_string(kMostLights) +
         "), diffuse=" + list(AllWords<model::DiffuseModel>()) +
         ", specular=" + list(AllWords<model::SpecularModel>()) +
         ", lobes=1|2, lights-are=near|distant, distance=A..B (of all lights, in the session's "
         "unit), color=free|white, white=N (which light is called "
         "white, 1 the strongest), intensity=per-frame|constant, ambient=harmonics|constant";
}

Status ApplyModelOption(const std::string& option, ModelChoice& choice) {
  const std::size_t equals = option.find('=');
  const std::string key = option.substr(0, equals);
  const std::string word = equals == std::string::npos ? "" : option.substr(equals + 1);
  if (key == "lights") return ChooseNumber(option, word, kMostLights, choice.lights);
  if (key == "lobes") return ChooseNumber(option, word, model::kMostLobes, choice.lobes);
  if (key == "white") return ChooseNumber(option, word, kMostLights, choice.white);
  if (key == "diffuse") return Choose(option, word, choice.diffuse);
  if (key == "specular") return Choose(option, word, choice.specular);
  if (key == "lights-are" || key == "distance")
    return ChooseNearness(option, key == "distance", word, choice);
  if (key == "color") return ChooseOf(option, word, {"free", "white"}, choice.coloured);
  if (key == "intensity") return ChooseOf(option, word, {"per-frame", "constant"}, choice.changing);
  if (key == "ambient") return ChooseOf(option, word, {"harmonics", "constant"}, choice.harmonics);
  const std::vector<std::string> keys = {"lights",     "diffuse",  "specular", "lobes",
                                         "lights-are", "distance", "color",    "white",
                                         "intensity",  "ambient"};
  return InputError("--model " + option + ": unknown key \"" + key + "\"" + DidYouMean(key, keys) +
                    ", allowed are " + Listed(keys));
}

}  // namespace turnlight::estimator::results
