// Proves: over many draws, at 0.3 px outline noise, white and correlated, 1 and 2 sigma of each
// parameter of X_AT hold the truth as often as they say (binomial 99 % bands, corrected for the
// number of parameters), and the error is within 0.1 mm and 0.1 degree each time.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "base/angles.h"
#include "base/parallel.h"
#include "tests/calib/calibrate/placement/outline_scenes.h"

namespace turnlight::calib::calibrate::placement {
namespace {

struct Coverage {
  int draws = 0, in_one = 0, in_two = 0;
};

// Of a normal value, and the half-width of the band in sigma: 99 % over six of them.
constexpr double kInOne = 0.6827, kInTwo = 0.9545, kBand = 3.14;

void ExpectCovered(int count, int draws, double share) {
  const double sigma = std::sqrt(share * (1.0 - share) * draws);
  EXPECT_NEAR(count, share * draws, kBand * sigma + 0.5) << "of " << draws;
}

void Study(const calib::TargetShape& shape, const OutlineNoise& noise, int draws, bool rotation) {
  const auto rig = SampleRig();
  std::vector<Eigen::Matrix<double, 6, 1>> errors(static_cast<std::size_t>(draws));
  std::vector<Matrix6> covariances(errors.size());
  ParallelFor(errors.size(), [&](std::size_t i) {
    calib::Pose truth = RandomPlace(RandomStream(77, i));
    if (!rotation) truth.rotation.setIdentity();
    std::vector<PickedPoint> picked;
    if (const auto* mesh = std::get_if<calib::MeshShape>(&shape))
      picked = Pick(rig, *mesh, truth, 2.0, i);
    const auto placed =
        PlaceTarget(rig, shape, Outlines(rig, shape, truth, Revolution(6), noise, 1000 + i), picked,
                    {.common_shift_sigma = 0.0});
    ASSERT_TRUE(placed) << placed.error().text;
    errors[i] = ErrorOf(placed->X_AT, truth);
    if (std::holds_alternative<calib::PlaneShape>(shape)) {
      const calib::Pose half = truth * calib::Turn(Eigen::Vector3d::UnitZ(), std::numbers::pi);
      const auto other = ErrorOf(placed->X_AT, half);
      if (other.norm() < errors[i].norm()) errors[i] = other;
    }
    covariances[i] = placed->covariance;
  });
  for (int p = rotation ? 0 : 3; p < 6; ++p) {
    Coverage seen;
    for (std::size_t i = 0; i < errors.size(); ++i) {
      const double size = std::abs(errors[i][p]) / std::sqrt(covariances[i](p, p));
      seen.in_one += size < 1.0;
      seen.in_two += size < 2.0;
      EXPECT_LT(errors[i].tail<3>().norm(), 0.1) << i;
      EXPECT_LT(RadToDeg(errors[i].head<3>().norm()), 0.1) << i;
    }
    std::printf("parameter %d: %.1f %% and %.1f %%\n", p, 100.0 * seen.in_one / draws,
                100.0 * seen.in_two / draws);
    ExpectCovered(seen.in_one, draws, kInOne);
    ExpectCovered(seen.in_two, draws, kInTwo);
  }
}

TEST(PlacementStudy, Sphere) { Study(calib::SphereShape{30.0}, {}, 400, false); }
TEST(PlacementStudy, SphereWithCorrelatedNoise) {
  Study(calib::SphereShape{30.0}, {0.3, 0.7, 0.0}, 400, false);
}
TEST(PlacementStudy, Board) { Study(calib::PlaneShape{70.0, 50.0, 1}, {}, 200, true); }
TEST(PlacementStudy, Mesh) { Study(Lump(), {}, 200, true); }

}  // namespace
}  // namespace turnlight::calib::calibrate::placement
