// Proves: spots of several lights in several views are told apart, whatever their order, with spots
// that belong to none and lights that some views do not show.
#include "calib/calibrate/probe/association.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/calib/calibrate/probe/ball_pictures.h"

namespace turnlight::calib::calibrate::probe {
namespace {

using Eigen::Vector3d;

Spot SpotAt(const Eigen::Vector2d& pixel) {
  Spot spot;
  spot.kind = SpotKind::kLight;
  spot.pixel = pixel;
  return spot;
}

struct Seen {
  std::vector<std::vector<Spot>> spots;
  std::vector<std::vector<int>> of;  // the light of each spot
};

// In every second view the lights' order is reversed.
Seen SpotsOf(const BallStudio& studio, const std::vector<Vector3d>& positions) {
  Seen seen;
  for (std::size_t view = 0; view < studio.views.size(); ++view) {
    seen.spots.emplace_back();
    seen.of.emplace_back();
    for (std::size_t k = 0; k < positions.size(); ++k) {
      const std::size_t light = view % 2 == 0 ? k : positions.size() - 1 - k;
      const Vector3d& p = positions[light];
      const auto pixel = PixelOfLight(studio.views[view], p.normalized(), 1.0 / p.norm());
      if (!pixel) continue;
      seen.spots.back().push_back(SpotAt(*pixel));
      seen.of.back().push_back(static_cast<int>(light));
    }
  }
  return seen;
}

TEST(Association, LightsAreToldApart) {
  BallPictures pictures;
  pictures.views = 9;
  const BallStudio studio(pictures);
  const std::vector<Vector3d> positions{
      {300, 200, 700}, {280, 320, 650}, {-5000, 3000, 9000}, {100, -400, 300}};
  const Seen seen = SpotsOf(studio, positions);
  const auto groups = GroupSpots(studio.views, seen.spots);
  ASSERT_EQ(groups.size(), positions.size());
  for (const SpotGroup& group : groups) {
    EXPECT_GE(group.size(), 8u);
    for (const SpotIndex& index : group)
      EXPECT_EQ(seen.of[index.view][index.spot], seen.of[group[0].view][group[0].spot]);
  }
}

TEST(Association, AStraySpotIsAGroupByItself) {
  BallPictures pictures;
  pictures.views = 5;
  const BallStudio studio(pictures);
  Seen seen = SpotsOf(studio, {{300, 200, 700}});
  seen.spots[2].insert(seen.spots[2].begin(), SpotAt({100.0, 170.0}));
  const auto groups = GroupSpots(studio.views, seen.spots);
  ASSERT_EQ(groups.size(), 2u);
  EXPECT_EQ(groups[0].size(), 5u);
  ASSERT_EQ(groups[1].size(), 1u);
  EXPECT_EQ(groups[1][0].view, 2u);
  EXPECT_EQ(groups[1][0].spot, 0u);
}

TEST(Association, NoSpotsNoGroups) {
  const BallStudio studio{BallPictures{}};
  EXPECT_TRUE(GroupSpots(studio.views, {{}}).empty());
}

}  // namespace
}  // namespace turnlight::calib::calibrate::probe
