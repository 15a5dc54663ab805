// Proves: a view is a keyframe if it is a step away from all before, not only from the last.
#include "calib/calibrate/handheld/view_change.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/angles.h"

namespace turnlight::calib::calibrate::handheld {
namespace {

Eigen::Vector3d At(double azimuth_deg) {
  return {std::cos(DegToRad(azimuth_deg)), std::sin(DegToRad(azimuth_deg)), 0.0};
}

TEST(ViewChange, TheFirstViewIsAKeyframe) {
  const ViewChange none(10.0);
  EXPECT_TRUE(none.IsKeyframe(At(0.0)));
  EXPECT_FALSE(none.NearestDeg(At(0.0)));
}

TEST(ViewChange, ComingBackGivesNoMoreKeyframes) {
  ViewChange views(10.0);
  int keyframes = 0;
  const auto look = [&](double azimuth_deg) {
    if (!views.IsKeyframe(At(azimuth_deg))) return;
    views.Add(At(azimuth_deg));
    ++keyframes;
  };
  for (int i = 0; i <= 60; ++i) look(i + 1e-9 * i);
  EXPECT_EQ(keyframes, 7);
  for (int i = 60; i >= 0; --i) look(i + 0.5);
  EXPECT_EQ(keyframes, 7);
  EXPECT_NEAR(*views.NearestDeg(At(65.0)), 5.0, 1e-6);
}

TEST(ViewChange, TheDirectionIsFromTheTargetToTheCamera) {
  Pose X_TC;
  X_TC.translation = {0.0, -30.0, 40.0};
  EXPECT_TRUE(ViewDirection(X_TC).isApprox(Eigen::Vector3d(0.0, -0.6, 0.8)));
}

}  // namespace
}  // namespace turnlight::calib::calibrate::handheld
