// Proves that the estimator still gets a slice of the random study right: number of lights,
// directions. Does not prove: the shares of the full study (docs/accuracy.md).
#include <gtest/gtest.h>

#include "bench/studies/job_runner.h"
#include "bench/studies/studies.h"

namespace turnlight::studies {
namespace {

// Quick ones: a ball, a board and a lump among them, 1 to 7 lights, all sensors. And 26 and 197,
// where most starts end with one light of three and of five.
class Slice : public testing::TestWithParam<int> {};

TEST_P(Slice, CountAndDirectionsAreRight) {
  const auto jobs = RandomJobs({GetParam(), GetParam() + 1});
  ASSERT_EQ(jobs.size(), 1u);
  const auto file = RunJobs("random", jobs, {});
  ASSERT_TRUE(file) << file.error().text;
  const Json& record = file->records.begin()->second;
  ASSERT_FALSE(record.contains("failed")) << record["failed"];
  EXPECT_EQ(record["lights_found"], record["lights_true"]);
  for (const Json& angle : record["angles_deg"]) {
    ASSERT_TRUE(angle.is_number());
    EXPECT_LT(angle.get<double>(), 0.3);
  }
}

INSTANTIATE_TEST_SUITE_P(Random, Slice, testing::Values(1, 2, 4, 6, 13, 16, 18, 26, 27, 197));

}  // namespace
}  // namespace turnlight::studies
