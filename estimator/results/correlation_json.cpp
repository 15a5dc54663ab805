#include "estimator/results/correlation_json.h"

#include <cmath>

namespace turnlight::estimator::results {
namespace {

constexpr double kUnits = 1e4;  // of the last decimal that is written, in one

}  // namespace

std::optional<nlohmann::ordered_json> CorrelationToJson(
    const uncertainty::Correlation& correlation) {
  using nlohmann::ordered_json;
  const std::size_t count = correlation.quantities.size();
  if (count == 0 || count > uncertainty::kMostCorrelated) return std::nullopt;
  ordered_json names = ordered_json::array(), sigmas = names, matrix = names;
  for (const uncertainty::CorrelatedQuantity& quantity : correlation.quantities) {
    names.push_back(quantity.name());
    sigmas.push_back(quantity.sigma);
  }
  for (const auto& row : correlation.matrix.rowwise()) {
    ordered_json& out = matrix.emplace_back(ordered_json::array());
    for (const double r : row) out.push_back(std::round(kUnits * r) / kUnits + 0.0);  // no -0
  }
  return ordered_json{
      {"names", std::move(names)}, {"sigmas", std::move(sigmas)}, {"matrix", std::move(matrix)}};
}

}  // namespace turnlight::estimator::results
