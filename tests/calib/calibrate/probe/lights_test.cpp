// Proves: from pictures of simulated balls, directions within 0.1 degree and positions of near
// lights inside 3 sigmas; near and distant are decided by significance, two balls tell more than
// one; what is uncertain is in the sigmas and the budget. Coverage is the study's.
#include "calib/calibrate/probe/lights.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "base/angles.h"
#include "tests/calib/calibrate/probe/ball_pictures.h"

namespace turnlight::calib::calibrate::probe {
namespace {

using Eigen::Vector3d;

rig::sim::BallLamp LampAt(const Vector3d& position, double radius_deg, double radiance) {
  return {position.normalized(), 1.0 / position.norm(), DegToRad(radius_deg), radiance};
}
rig::sim::BallLamp Distant(const Vector3d& direction, double radius_deg, double radiance) {
  return {direction.normalized(), 0.0, DegToRad(radius_deg), radiance};
}

std::vector<std::vector<Spot>> FindAll(const BallPictures& pictures, const BallStudio& studio,
                                       const std::vector<BallView>& views) {
  std::vector<std::vector<Spot>> spots;
  for (std::size_t i = 0; i < views.size(); ++i)
    spots.push_back(FindSpots(TakePicture(pictures, studio, i), {}, views[i]).spots);
  return spots;
}

std::vector<Perturbation> CentreSigma(const std::vector<BallView>& views, double sigma) {
  std::vector<Perturbation> perturbations;
  for (int axis = 0; axis < 3; ++axis) {
    perturbations.push_back({"ball centre", views});
    for (BallView& view : perturbations.back().views) view.ball.center[axis] += sigma;
  }
  return perturbations;
}

double AngleDeg(const Vector3d& a, const Vector3d& b) {
  return RadToDeg(std::acos(std::min(1.0, a.normalized().dot(b.normalized()))));
}

const Vector3d kPosition(300.0, 250.0, 500.0), kFar(-0.4, 0.2, 0.8);

BallPictures Scene(int views) {
  BallPictures pictures;
  pictures.views = views;
  pictures.noise = 0.003;
  pictures.white = 1.0;
  pictures.room.ceiling = 0.1;
  pictures.room.lamps = {LampAt(kPosition, 1.5, 5.0), Distant(kFar, 1.0, 5.0)};
  return pictures;
}

TEST(Lights, NearAndDistant) {
  const BallPictures pictures = Scene(6);
  const BallStudio studio(pictures);
  const auto found = FindLights(studio.views, FindAll(pictures, studio, studio.views), {});
  ASSERT_EQ(found.lights.size(), 2u);
  EXPECT_TRUE(found.candidates.empty());
  const ProbeLight& near = found.lights[0].near ? found.lights[0] : found.lights[1];
  const ProbeLight& far = found.lights[0].near ? found.lights[1] : found.lights[0];
  ASSERT_TRUE(near.near && near.position);
  EXPECT_LT(AngleDeg(near.direction, kPosition), 0.1);
  const Vector3d off = *near.position - kPosition;
  EXPECT_LT(off.dot(near.position_covariance.inverse() * off), 14.2);  // 3 sigmas of three
  EXPECT_NEAR(1.0 / near.inverse_distance, kPosition.norm(), 3.0 * near.sigma.distance);
  ASSERT_TRUE(near.distance_min);
  EXPECT_LT(*near.distance_min, near.position->norm());
  EXPECT_FALSE(far.near);
  EXPECT_LT(AngleDeg(far.direction, kFar), 0.1);
  ASSERT_TRUE(far.distance_min);
  EXPECT_GT(*far.distance_min, 2000.0);
  EXPECT_TRUE(near.clipped);
  EXPECT_FALSE(near.intensity);
}

TEST(Lights, OneViewTellsADirectionWhereItWasSeen) {
  const BallPictures pictures = Scene(1);
  const BallStudio studio(pictures);
  const auto found = FindLights(studio.views, FindAll(pictures, studio, studio.views), {});
  ASSERT_EQ(found.lights.size(), 2u);
  for (const ProbeLight& light : found.lights) {
    EXPECT_FALSE(light.near);
    EXPECT_FALSE(light.distance_min);
    EXPECT_EQ(light.scatter, 0.0);
    const double near = AngleDeg(light.direction_at_reference, kPosition - light.reference);
    EXPECT_LT(std::min(near, AngleDeg(light.direction, kFar)), 0.1);
  }
}

TEST(Lights, WhereTheBallIsMayBeUncertain) {
  const BallPictures pictures = Scene(6);
  const BallStudio studio(pictures);
  std::vector<BallView> views = studio.views;
  for (BallView& view : views) view.ball.center += Vector3d(0.15, -0.1, 0.1);
  const auto found = FindLights(views, FindAll(pictures, studio, views), CentreSigma(views, 0.15));
  ASSERT_EQ(found.lights.size(), 2u);
  for (const ProbeLight& light : found.lights) {
    ASSERT_EQ(light.budget.size(), 2u);
    EXPECT_EQ(light.budget[0].item, "spots");
    EXPECT_EQ(light.budget[1].item, "ball centre");
    EXPECT_GT(light.sigma.direction, light.stat.direction);
    const double far = AngleDeg(light.direction, kFar);
    const double error =
        std::min(far, AngleDeg(light.direction_at_reference, kPosition - light.reference));
    EXPECT_LT(error, 3.0 * RadToDeg(light.sigma.direction));
  }
}

// Two balls a hand apart: the same light's distance is known better than from one.
TEST(Lights, TwoBallsTellADistanceBetter) {
  BallPictures first = Scene(2);
  first.arc_deg = 60.0;
  first.focal = 1200.0;
  first.width = first.height = 500;
  first.room.lamps = {LampAt(kPosition, 1.5, 5.0)};
  BallPictures second = first;
  second.ball.center = Vector3d(-40.0, 40.0, 0.0);
  second.seed = 2;
  const BallStudio one(first), other(second);
  auto spots = FindAll(first, one, one.views);
  const auto from_one = FindLights(one.views, spots, {});
  std::vector<BallView> views = one.views;
  views.insert(views.end(), other.views.begin(), other.views.end());
  for (auto& more : FindAll(second, other, other.views)) spots.push_back(std::move(more));
  const auto from_both = FindLights(views, spots, {});
  ASSERT_EQ(from_one.lights.size(), 1u);
  ASSERT_EQ(from_both.lights.size(), 1u);
  const ProbeLight& light = from_both.lights[0];
  ASSERT_TRUE(light.position);
  const Vector3d off = *light.position - kPosition;
  EXPECT_LT(off.dot(light.position_covariance.inverse() * off), 14.2);
  if (from_one.lights[0].near) {
    EXPECT_LT(light.sigma.distance, from_one.lights[0].sigma.distance);
  }
}

// What goes round with the camera is no light of the room.
TEST(Lights, ALampOnTheCameraIsACandidate) {
  BallPictures pictures;
  pictures.views = 6;
  const BallStudio studio(pictures);
  std::vector<std::vector<Spot>> spots;
  for (const BallView& view : studio.views) {
    const Vector3d lamp = view.X_WC * Vector3d(60.0, -40.0, 0.0);
    Spot spot;
    spot.kind = SpotKind::kLight;
    spot.pixel = *PixelOfLight(view, lamp.normalized(), 1.0 / lamp.norm());
    spot.noise_covariance = 1e-4 * Eigen::Matrix2d::Identity();
    spots.push_back({spot});
  }
  const auto found = FindLights(studio.views, spots, {});
  EXPECT_TRUE(found.lights.empty());
  EXPECT_EQ(found.candidates.size(), 6u);
  EXPECT_NE(found.candidates[0].why.find("stand still"), std::string::npos);
}

TEST(Lights, IntensitiesAreRelativeToTheStrongest) {
  BallPictures pictures;
  pictures.room.lamps = {Distant({0.5, 0.3, 0.8}, 1.0, 4.0), Distant({0.6, -0.5, 0.6}, 1.0, 8.0)};
  const BallStudio studio(pictures);
  const auto found = FindLights(studio.views, FindAll(pictures, studio, studio.views), {});
  ASSERT_EQ(found.lights.size(), 2u);
  EXPECT_DOUBLE_EQ(found.lights[0].intensity.value(), 1.0);
  EXPECT_NEAR(found.lights[1].intensity.value(), 0.5, 0.02);
}

}  // namespace
}  // namespace turnlight::calib::calibrate::probe
