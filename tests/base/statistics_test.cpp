// Proves: each order statistic is the one that its comment says, for odd, even, single and no
// values, with ties and infinities. Does not prove which of them a caller should have taken.
#include "base/statistics.h"

#include <gtest/gtest.h>

#include <limits>

namespace turnlight {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(OrderStatistics, StandWhereTheirIndexSays) {
  for (std::size_t index = 0; index < 5; ++index) {
    std::vector<int> values = {40, 10, 30, 0, 20};
    EXPECT_EQ(OrderStatistic(values, index), static_cast<int>(10 * index));
  }
  std::vector<int> values = {2, 1};
  EXPECT_EQ(OrderStatistic(values, 7), 2) << "past the end is the largest";
  std::vector<int> none;
  EXPECT_EQ(OrderStatistic(none, 0), 0);
}

TEST(OrderStatistics, MedianIsTheUpperOfTwo) {
  std::vector<double> odd = {3, 1, 2}, even = {4, 1, 3, 2}, one = {7}, none;
  EXPECT_EQ(Median(odd), 2);
  EXPECT_EQ(Median(even), 3);
  EXPECT_EQ(Median(one), 7);
  EXPECT_EQ(Median(none), 0);
}

TEST(OrderStatistics, LowerQuantileIsAtOrBelowTheShare) {
  std::vector<double> values = {5, 3, 1, 4, 2};
  EXPECT_EQ(LowerQuantile(values, 0.0), 1);
  EXPECT_EQ(LowerQuantile(values, 0.49), 2);
  EXPECT_EQ(LowerQuantile(values, 0.5), 3);
  EXPECT_EQ(LowerQuantile(values, 0.999), 4);
  EXPECT_EQ(LowerQuantile(values, 1.0), 5);
  std::vector<double> none;
  EXPECT_EQ(LowerQuantile(none, 0.5), 0);
}

TEST(OrderStatistics, NearestRankIsNotExceededByTheShare) {
  const std::vector<double> values = {5, NAN, 3, 1, kInfinity, 4, 2, -kInfinity};
  EXPECT_EQ(NearestRank(values, 0.0), 1);
  EXPECT_EQ(NearestRank(values, 0.2), 1);
  EXPECT_EQ(NearestRank(values, 0.21), 2);
  EXPECT_EQ(NearestRank(values, 0.95), 5);
  EXPECT_EQ(NearestRank(values, 1.0), 5);
  EXPECT_EQ(NearestRank(std::vector<double>{NAN}, 0.5), 0);
}

TEST(OrderStatistics, InterpolatedIsLinearBetween) {
  const std::vector<double> values = {30, 10, 20};
  EXPECT_EQ(InterpolatedQuantile(values, 0.0), 10);
  EXPECT_DOUBLE_EQ(InterpolatedQuantile(values, 0.25), 15);
  EXPECT_EQ(InterpolatedQuantile(values, 0.5), 20);
  EXPECT_DOUBLE_EQ(InterpolatedQuantile(values, 0.95), 29);
  EXPECT_EQ(InterpolatedQuantile(values, 1.0), 30);
  EXPECT_TRUE(std::isnan(InterpolatedQuantile({}, 0.5)));
  EXPECT_EQ(InterpolatedQuantile({1.0, kInfinity, kInfinity}, 0.9), kInfinity);
  EXPECT_EQ(InterpolatedQuantile({1.0, kInfinity}, 0.0), 1.0);
}

}  // namespace
}  // namespace turnlight
