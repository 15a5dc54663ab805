// Proves: the harmonics are orthogonal with a mean square of 1, and a matte surface under a distant
// light field of theirs gets what the header says, by sums over the sphere. Does not prove that
// order 2 is enough for a given light field.
#include "estimator/model/spherical_harmonics.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <numbers>

#include "estimator/model/direction_lattice.h"
#include "estimator/model/reflectance/scalar.h"

namespace turnlight::estimator::model {
namespace {

using Values = Eigen::Matrix<double, kHarmonics, 1>;

Values At(const Eigen::Vector3d& n) {
  Values out;
  FillHarmonics<reflectance::Scalar<double>>(n.x(), n.y(), n.z(), out.data());
  return out;
}

TEST(SphericalHarmonics, AreOrthonormalByMeansOverTheSphere) {
  const auto directions = SphereDirections(20000);
  Eigen::Matrix<double, kHarmonics, kHarmonics> products;
  products.setZero();
  Values mean = Values::Zero();
  for (const Eigen::Vector3d& n : directions) {
    products += At(n) * At(n).transpose() / static_cast<double>(directions.size());
    mean += At(n) / static_cast<double>(directions.size());
  }
  EXPECT_LT((products - products.Identity()).cwiseAbs().maxCoeff(), 2e-3);
  EXPECT_LT(mean.cwiseAbs().maxCoeff(), 2e-3);
}

TEST(SphericalHarmonics, GiveAMatteSurfaceWhatTheySay) {
  const auto directions = SphereDirections(40000);
  const double solid_angle = 4.0 * std::numbers::pi / static_cast<double>(directions.size());
  const Eigen::Vector3d normal = Eigen::Vector3d(0.3, -0.5, 0.7).normalized();
  for (int j = 0; j < kHarmonics; ++j) {
    double irradiance = 0.0;
    for (const Eigen::Vector3d& u : directions)
      irradiance += solid_angle * std::max(normal.dot(u), 0.0) * At(u)[j];
    const double share = j < 3 ? 2.0 / 3.0 : 1.0 / 4.0;
    EXPECT_NEAR(irradiance, std::numbers::pi * share * At(normal)[j], 3e-3) << j;
  }
}

}  // namespace
}  // namespace turnlight::estimator::model
