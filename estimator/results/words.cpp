#include "estimator/results/words.h"

namespace turnlight::estimator::results {

template <>
std::span<const Word<model::SpecularModel>> Words() {
  using enum model::SpecularModel;
  static constexpr Word<model::SpecularModel> kWords[] = {
      {"none", kNone}, {"phong", kPhong}, {"blinn-phong", kBlinnPhong}};
  return kWords;
}

template <>
std::span<const Word<model::DiffuseModel>> Words() {
  using enum model::DiffuseModel;
  static constexpr Word<model::DiffuseModel> kWords[] = {{"lambert", kLambert},
                                                         {"oren-nayar", kOrenNayar}};
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
