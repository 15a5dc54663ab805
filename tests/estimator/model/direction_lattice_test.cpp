// Proves: the lattice has as many unit directions as were asked for, in the hemisphere they were
// asked for or in pairs of opposites, and covers it evenly: every cap has its share, no two are
// close, no hole is wide. Does not prove that another lattice would not be more even still.
#include "estimator/model/direction_lattice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/estimator/directions.h"

namespace turnlight::estimator::model {
namespace {

using Eigen::Vector3d;

double NearestCosine(const std::vector<Vector3d>& directions, const Vector3d& to) {
  double most = -1.0;
  for (const Vector3d& direction : directions)
    if (&direction != &to) most = std::max(most, direction.dot(to));
  return most;
}

TEST(DirectionLattice, FillsTheHemisphereAroundItsAxis) {
  for (const Vector3d& up : {Vector3d(0, 0, 1), Vector3d(0, 0, -1), Vector3d(2, -1, 0.5)}) {
    const auto directions = HemisphereDirections(24, up.normalized());
    ASSERT_EQ(directions.size(), 24u);
    for (const Vector3d& direction : directions) {
      EXPECT_NEAR(direction.norm(), 1.0, 1e-14);
      EXPECT_GT(direction.dot(up), 0.0);
    }
  }
}

// By area: a cap down to height z holds the share 1 - z.
TEST(DirectionLattice, EveryCapHasItsShare) {
  const Vector3d up = Vector3d(1, 2, 3).normalized();
  const auto directions = HemisphereDirections(1000, up);
  for (const double z : {0.9, 0.5, 0.1})
    EXPECT_NEAR(std::count_if(directions.begin(), directions.end(),
                              [&](const Vector3d& d) { return d.dot(up) > z; }),
                1000.0 * (1.0 - z), 1.0);
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& direction : directions) mean += direction / 1000.0;
  EXPECT_LT((mean - 0.5 * up).norm(), 0.005);
}

// N even directions of the sphere are about sqrt(4 pi / N) apart.
TEST(DirectionLattice, NeitherClosePairsNorHoles) {
  for (const int count : {50, 200, 1000}) {
    const auto directions = SphereDirections(count);
    ASSERT_EQ(directions.size(), static_cast<std::size_t>(count));
    const double spacing = std::sqrt(4.0 * M_PI / count);
    for (const Vector3d& direction : directions)
      EXPECT_GT(std::acos(NearestCosine(directions, direction)), 0.45 * spacing) << count;
    const RandomStream random(2, 2);
    for (std::uint64_t i = 0; i < 2000; ++i)
      EXPECT_LT(std::acos(NearestCosine(directions, RandomUnit(random, i))), 1.1 * spacing)
          << count;
  }
}

TEST(DirectionLattice, TheSphereIsAHemisphereAndItsOpposites) {
  const auto directions = SphereDirections(200);
  for (std::size_t i = 0; i < 100; ++i) {
    EXPECT_GT(directions[i].z(), 0.0);
    EXPECT_EQ(directions[i + 100], -directions[i]);
  }
}

}  // namespace
}  // namespace turnlight::estimator::model
