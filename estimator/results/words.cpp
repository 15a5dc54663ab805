#include "estimator/results/words.h"

#include "estimator/model/reflectance/models.h"

namespace turnlight::estimator::results {

namespace {

// The words of the models that there are, after `first`.
template <typename Model>
std::vector<Word<Model>> WordsOfModels(std::vector<Word<Model>> first, int count) {
  for (int i = 0; i < count; ++i) {
    const auto model = static_cast<Model>(first.size());
    first.push_back({model::FactsOf(model).word, model});
  }
  return first;
}

}  // namespace

template <>
std::span<const Word<model::SpecularModel>> Words() {
  static const auto kWords = WordsOfModels<model::SpecularModel>(
      {{"none", model::SpecularModel::kNone}}, model::reflectance::Lobes::kCount);
  return kWords;
}

template <>
std::span<const Word<model::DiffuseModel>> Words() {
  static const auto kWords =
      WordsOfModels<model::DiffuseModel>({}, model::reflectance::DiffuseModels::kCount);
  return kWords;
}

template <>
std::span<const Word<solve::Stopped>> Words() {
  using enum solve::Stopped;
  static constexpr Word<solve::Stopped> kWords[] = {{"converged", kTolerance},
                                                    {"no-descent", kNoDescent},
                                                    {"iteration-limit", kIterationLimit},
                                                    {"not-finite", kNotFinite}};
  return kWords;
}

template <>
std::span<const Word<Method>> Words() {
  using enum Method;
  static constexpr Word<Method> kWords[] = {{"lm", kLeastSquares}, {"paper", kPaper}};
  return kWords;
}

}  // namespace turnlight::estimator::results
