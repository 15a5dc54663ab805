// Proves: names, sigmas and numbers stand as docs/design.md says, rounded, symmetric, with ones on
// the diagonal; what is too large or not there is left out. Does not prove the correlations.
#include "estimator/results/correlation_json.h"

#include <gtest/gtest.h>

namespace turnlight::estimator::results {
namespace {

using Json = nlohmann::ordered_json;

uncertainty::Correlation OfSize(std::size_t count) {
  uncertainty::Correlation out;
  out.quantities.resize(count, {"ambient", "", {}, 0.5});
  const auto rows = static_cast<Eigen::Index>(count);
  out.matrix = Eigen::MatrixXd::Identity(rows, rows);
  return out;
}

TEST(CorrelationToJson, NamesSigmasAndRoundedNumbers) {
  uncertainty::Correlation correlation;
  correlation.quantities = {{"direction", "azimuth", 1, 0.01}, {"ambient", "", {}, 0.002}};
  correlation.matrix.resize(2, 2);
  correlation.matrix << 1.0, -0.123456, -0.123456, 1.0;
  const auto written = CorrelationToJson(correlation);
  ASSERT_TRUE(written);
  EXPECT_EQ((*written)["names"], Json({"direction of light 2, azimuth", "ambient"}));
  EXPECT_EQ((*written)["sigmas"], Json({0.01, 0.002}));
  EXPECT_EQ((*written)["matrix"], Json({{1.0, -0.1235}, {-0.1235, 1.0}}));
  correlation.matrix(0, 1) = correlation.matrix(1, 0) = -1e-9;
  EXPECT_EQ((*CorrelationToJson(correlation))["matrix"].dump(), "[[1.0,0.0],[0.0,1.0]]");
}

TEST(CorrelationToJson, NothingAndTooMuchAreLeftOut) {
  EXPECT_FALSE(CorrelationToJson({}));
  EXPECT_TRUE(CorrelationToJson(OfSize(1)));
  EXPECT_TRUE(CorrelationToJson(OfSize(uncertainty::kMostCorrelated)));
  EXPECT_FALSE(CorrelationToJson(OfSize(uncertainty::kMostCorrelated + 1)));
}

}  // namespace
}  // namespace turnlight::estimator::results
