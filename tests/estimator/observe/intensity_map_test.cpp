// Proves: cells lie where their directions say; an even picture makes an even map, and a bright
// spot is where it was put, also across the seam of the azimuth and at the pole; the bright area is
// what the share says, brightest first; clusters are led by the first comers. Does not prove that
// spots are lights: find_lights_test does.
#include "estimator/observe/intensity_map.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/estimator/random_observations.h"

namespace turnlight::estimator::observe {
namespace {

using Eigen::Vector3d;

// Radiance by mirrored direction: 0.1, and 1 more at each spot, falling off within 8 degrees. Views
// are mirrored to all of the sphere.
Observations Spots(const std::vector<Vector3d>& spots) {
  Observations all = RandomObservations(40000, 1, 1).observations;
  const RandomStream random(9, 9);
  for (std::size_t i = 0; i < all.used; ++i) {
    const Vector3d w = RandomUnit(random, i);
    double value = 0.1;
    for (const Vector3d& spot : spots) value += std::exp(-0.5 * std::pow(AngleDeg(w, spot) / 8, 2));
    for (int k = 0; k < 3; ++k) all.mirrored[k][i] = static_cast<float>(w[k]);
    all.radiance[0][i] = static_cast<float>(value);
  }
  return all;
}

TEST(IntensityMap, CellsLieWhereTheirDirectionsSay) {
  EXPECT_LT(AngleDeg(MapDirection(0, 0), Vector3d::UnitZ()), 0.51);
  EXPECT_LT(AngleDeg(MapDirection(90, 0), Vector3d::UnitX()), 0.75);
  EXPECT_LT(AngleDeg(MapDirection(90, 90), Vector3d::UnitY()), 0.75);
  EXPECT_LT(AngleDeg(MapDirection(179, 200), -Vector3d::UnitZ()), 0.51);
}

TEST(IntensityMap, EvenPicturesMakeAnEvenMap) {
  const IntensityMap map = MakeIntensityMap(Spots({}));
  ASSERT_EQ(map.intensity.size(), cv::Size(360, 180));
  int seen = 0;
  for (const float value : map.intensity)
    if (!std::isnan(value)) {
      EXPECT_NEAR(value, 0.1f, 1e-6f);
      ++seen;
    }
  EXPECT_GT(seen, 20000);
  EXPECT_LT(seen, 40001) << "a cell that nothing was seen in is no number";
}

TEST(IntensityMap, ABrightSpotIsWhereItIs) {
  for (const Vector3d& spot :
       {Vector3d(1.0, 0.001, 0.3), Vector3d(0.02, 0.0, 1.0), Vector3d(-0.5, -0.7, -0.4)}) {
    const IntensityMap map = MakeIntensityMap(Spots({spot.normalized()}));
    const auto area = HighIntensityArea(map, kHighShare);
    ASSERT_FALSE(area.empty());
    EXPECT_LT(AngleDeg(area.front().direction, spot), 3.0);
    for (std::size_t i = 0; i < area.size(); ++i) {
      EXPECT_LT(AngleDeg(area[i].direction, spot), 12.0);  // half height is at 9.4 degrees
      if (i > 0) EXPECT_LE(area[i].intensity, area[i - 1].intensity);
    }
  }
}

TEST(IntensityMap, TwoSpotsAreTwoClusters) {
  const std::vector<Vector3d> spots = {Vector3d(0.3, 0.2, 1.0).normalized(),
                                       Vector3d(-0.7, 0.3, 0.6).normalized()};
  const auto clusters = LeaderClustering(
      HighIntensityArea(MakeIntensityMap(Spots(spots)), kHighShare), DegToRad(kClusterRadiusDeg));
  ASSERT_EQ(clusters.size(), 2u);
  for (const Vector3d& spot : spots)
    EXPECT_LT(
        std::min(AngleDeg(clusters[0].direction, spot), AngleDeg(clusters[1].direction, spot)),
        3.0);
}

TEST(LeaderClustering, TheFirstComersLead) {
  const auto at = [](double degrees, double intensity) {
    return MapPoint{{std::cos(DegToRad(degrees)), std::sin(DegToRad(degrees)), 0.0}, intensity};
  };
  const auto leaders =
      LeaderClustering({at(0, 3), at(20, 2.5), at(30, 2), at(50, 1.5), at(-24, 1)}, DegToRad(25));
  ASSERT_EQ(leaders.size(), 2u);
  EXPECT_EQ(leaders[0].intensity, 3.0);
  EXPECT_EQ(leaders[1].intensity, 2.0);
  EXPECT_TRUE(LeaderClustering({}, 1.0).empty());
}

}  // namespace
}  // namespace turnlight::estimator::observe
