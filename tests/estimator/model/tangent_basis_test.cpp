// Proves: the two axes are orthonormal and right-handed with the direction, to rounding, also at
// and beside the poles. Does not prove that they are continuous: they jump where z changes its
// sign.
#include "estimator/model/tangent_basis.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "tests/estimator/directions.h"

namespace turnlight::estimator::model {
namespace {

using Eigen::Vector3d;

void ExpectBasis(const Vector3d& u) {
  const Eigen::Matrix<double, 3, 2> basis = TangentBasis(u);
  Eigen::Matrix3d all;
  all << u, basis;
  EXPECT_LT((all.transpose() * all - Eigen::Matrix3d::Identity()).norm(), 1e-14) << u.transpose();
  EXPECT_NEAR(all.determinant(), 1.0, 1e-14) << u.transpose();
}

TEST(TangentBasis, IsOrthonormalAndRightHanded) {
  const RandomStream random(1, 1);
  for (std::uint64_t i = 0; i < 1000; ++i) ExpectBasis(RandomUnit(random, i));
}

TEST(TangentBasis, AlsoAtThePolesAndTheEquator) {
  for (const double z : {1.0, -1.0}) {
    ExpectBasis(z * Vector3d::UnitZ());
    for (const double off : {1e-4, 1e-8, 1e-12, 1e-300})
      ExpectBasis(Vector3d(off, -0.3 * off, z).normalized());
  }
  for (const double z : {0.0, -0.0, 1e-300, -1e-300})
    for (const double azimuth : {0.0, 1.0, 3.0, -2.0})
      ExpectBasis({std::cos(azimuth), std::sin(azimuth), z});
}

}  // namespace
}  // namespace turnlight::estimator::model
