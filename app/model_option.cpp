#include "app/model_option.h"

#include <charconv>
#include <utility>
#include <vector>

#include "base/format.h"
#include "base/nearest.h"

namespace turnlight::app {
namespace {

using estimator::model::DiffuseModel;
using estimator::model::ModelChoice;
using estimator::model::SpecularModel;

constexpr int kMostLights = 32;

template <typename Value>
Status Choose(const std::string& option, const std::string& word,
              const std::vector<std::pair<std::string, Value>>& allowed,
              std::optional<Value>& out) {
  std::vector<std::string> names;
  for (const auto& [name, value] : allowed) {
    if (name == word) {
      out = value;
      return {};
    }
    names.push_back(name);
  }
  return InputError("--model " + option + ": \"" + word + "\", allowed are " + Listed(names));
}

Status ChooseCount(const std::string& option, const std::string& word, std::optional<int>& out) {
  int count = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), count);
  if (error != std::errc() || end != word.data() + word.size() || count < 1 || count > kMostLights)
    return InputError("--model " + option + ": \"" + word +
                      "\", allowed is a whole number from 1 to " + std::to_string(kMostLights));
  out = count;
  return {};
}

}  // namespace

Status ApplyModelOption(const std::string& option, ModelChoice& choice) {
  const std::size_t equals = option.find('=');
  const std::string key = option.substr(0, equals);
  const std::string word = equals == std::string::npos ? "" : option.substr(equals + 1);
  if (key == "lights") return ChooseCount(option, word, choice.lights);
  if (key == "diffuse")
    return Choose<DiffuseModel>(
        option, word,
        {{"lambert", DiffuseModel::kLambert}, {"oren-nayar", DiffuseModel::kOrenNayar}},
        choice.diffuse);
  if (key == "specular")
    return Choose<SpecularModel>(option, word,
                                 {{"none", SpecularModel::kNone},
                                  {"phong", SpecularModel::kPhong},
                                  {"blinn-phong", SpecularModel::kBlinnPhong}},
                                 choice.specular);
  if (key == "lights-are")
    return Choose<bool>(option, word, {{"near", true}, {"distant", false}}, choice.near);
  const std::vector<std::string> keys = {"lights", "diffuse", "specular", "lights-are"};
  return InputError("--model " + option + ": unknown key \"" + key + "\"" + DidYouMean(key, keys) +
                    ", allowed are " + Listed(keys));
}

}  // namespace turnlight::app
