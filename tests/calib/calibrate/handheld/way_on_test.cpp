// Proves that the way on is the shortest one to a view that is new, in the words of who holds the
// camera, and never down to the board. Does not test what a person makes of it.
#include "calib/calibrate/handheld/way_on.h"

#include <gtest/gtest.h>

#include "base/angles.h"
#include "calib/rig_geometry.h"

namespace turnlight::calib::calibrate::handheld {
namespace {

Pose At(double azimuth_deg, double elevation_deg) {
  return LookAtOrigin(DegToRad(azimuth_deg), DegToRad(elevation_deg), 400.0);
}

// Around T with keyframes at these azimuths and elevations.
std::string Way(const std::vector<std::pair<double, double>>& keyframes, const Pose& X_TC) {
  ViewChange kept(10.0);
  for (const auto& [azimuth, elevation] : keyframes)
    kept.Add(ViewDirection(At(azimuth, elevation)));
  return WayOn(kept, X_TC, Eigen::Vector3d::UnitZ());
}

TEST(WayOn, IsAwayFromTheNearestKeyframe) {
  // Positive azimuths are to the right of who looks at the target.
  EXPECT_EQ(Way({{0.0, 40.0}}, At(4.0, 40.0)), "to the right");
  EXPECT_EQ(Way({{0.0, 40.0}}, At(-4.0, 40.0)), "to the left");
  EXPECT_EQ(Way({{0.0, 40.0}}, At(0.0, 44.0)), "up");
  EXPECT_EQ(Way({{0.0, 40.0}}, At(0.0, 36.0)), "down");
}

TEST(WayOn, PassesOverWhatIsTaken) {
  EXPECT_EQ(Way({{0.0, 40.0}, {14.0, 40.0}, {7.0, 50.0}, {7.0, 30.0}}, At(12.0, 40.0)),
            "to the right");
}

TEST(WayOn, NeverLeadsDownToTheBoard) { EXPECT_NE(Way({{0.0, 26.0}}, At(0.0, 24.0)), "down"); }

TEST(WayOn, IsInTheCamerasWords) {
  // Rolled by 90 degrees: what was to the right is up or down now.
  const Pose rolled = At(4.0, 40.0) * Turn(Eigen::Vector3d::UnitZ(), DegToRad(90.0));
  EXPECT_EQ(Way({{0.0, 40.0}}, rolled), "up");
}

TEST(WayOn, SaysSoWhereNothingIsLeft) {
  ViewChange wide(180.0);
  wide.Add(ViewDirection(At(0.0, 40.0)));
  EXPECT_EQ(WayOn(wide, At(0.0, 45.0), Eigen::Vector3d::UnitZ()),
            "on, to where none was taken yet");
}

}  // namespace
}  // namespace turnlight::calib::calibrate::handheld
