// Proves: what a stated light and a measured one are compared by, and the words for it; files that
// are no list of lights are refused in words that name the place.
#include "calib/calibrate/probe/against.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/angles.h"
#include "calib/calibrate/probe/ball.h"

namespace turnlight::calib::calibrate::probe {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

ProbeLight Measured(const Vector3d& direction, double sigma_deg) {
  ProbeLight light;
  light.direction = light.direction_at_reference = direction.normalized();
  const auto across = Across(light.direction);
  const double sigma = DegToRad(sigma_deg);
  light.reference_covariance = light.direction_covariance =
      sigma * sigma * across * across.transpose();
  light.sigma.direction = sigma;
  return light;
}

void SetDistance(ProbeLight& light, double distance, double sigma) {
  light.near = true;
  light.inverse_distance = 1.0 / distance;
  light.position = distance * light.direction;
  light.sigma.distance = sigma;
}

StatedLight Stated(const Vector3d& direction, double sigma_deg) {
  StatedLight light;
  light.direction = direction.normalized();
  light.direction_sigma = DegToRad(sigma_deg);
  return light;
}

const Vector3d kUp(0.0, 0.0, 1.0), kBeside(std::tan(DegToRad(0.5)), 0.0, 1.0);

TEST(Against, SigmasOfBothSidesCount) {
  const auto close = CompareLights({Measured(kUp, 0.15)}, {Stated(kBeside, 0.15)}, "mm");
  ASSERT_EQ(close.lights.size(), 1u);
  EXPECT_TRUE(close.agrees);
  EXPECT_NEAR(RadToDeg(close.lights[0].angle), 0.5, 1e-9);
  EXPECT_NEAR(close.lights[0].angle_sigmas, 0.5 / std::hypot(0.15, 0.15), 1e-3);
  EXPECT_NE(close.lights[0].words.find("agree"), std::string::npos);
  const auto apart = CompareLights({Measured(kUp, 0.05)}, {Stated(kBeside, 0.05)}, "mm");
  EXPECT_FALSE(apart.agrees);
  EXPECT_NE(apart.lights[0].words.find("differ"), std::string::npos);
}

TEST(Against, DistancesAreCompared) {
  ProbeLight light = Measured(kUp, 0.1);
  SetDistance(light, 800.0, 10.0);
  StatedLight stated = Stated(kUp, 0.1);
  stated.distance = 820.0;
  stated.distance_sigma = 5.0;
  stated.position = 820.0 * kUp;
  EXPECT_TRUE(CompareLights({light}, {stated}, "mm").agrees);
  stated.distance = 900.0;
  const auto apart = CompareLights({light}, {stated}, "mm");
  EXPECT_FALSE(apart.agrees);
  EXPECT_NEAR(apart.lights[0].distance_sigmas.value(), 100.0 / std::hypot(10.0, 5.0), 1e-9);
}

TEST(Against, ABoundIsKeptOrNot) {
  ProbeLight light = Measured(kUp, 0.1);
  light.distance_min = 2000.0;
  StatedLight stated = Stated(kUp, 0.1);
  stated.distance = 500.0;
  stated.distance_sigma = 10.0;
  stated.position = 500.0 * kUp;
  EXPECT_FALSE(CompareLights({light}, {stated}, "mm").agrees);
  stated.distance = 3000.0;
  EXPECT_TRUE(CompareLights({light}, {stated}, "mm").agrees);
}

// A near light is looked at from where the ball was, not from W's origin.
TEST(Against, APositionIsSeenFromTheBall) {
  ProbeLight light = Measured(Vector3d(-100.0, 0.0, 1000.0), 0.05);
  light.reference = Vector3d(100.0, 0.0, 0.0);
  StatedLight stated = Stated(kUp, 0.05);
  stated.position = Vector3d(0.0, 0.0, 1000.0);
  stated.distance = 1000.0;
  const auto agreement = CompareLights({light}, {stated}, "mm");
  EXPECT_LT(RadToDeg(agreement.lights[0].angle), 1e-6);
}

TEST(Against, LightsWithoutPartnersAreNamed) {
  const auto agreement = CompareLights({Measured(kUp, 0.1)}, {Stated({1.0, 0.0, 0.0}, 0.1)}, "mm");
  EXPECT_FALSE(agreement.agrees);
  ASSERT_EQ(agreement.lights.size(), 2u);
  EXPECT_EQ(agreement.lights[0].words, "light 1 of the ball is not there");
  EXPECT_EQ(agreement.lights[1].words, "its light 1 is not seen in the ball");
}

TEST(Against, FilesOfLightsAreRead) {
  const auto lights = ReadStatedLights(
      R"({"format": "turnlight-result", "lights": [
          {"direction": [0, 0, 2], "direction_sigma_deg": 0.5, "distance": 900, "distance_sigma": 9,
           "position": null, "intensity": 1.0},
          {"direction": [0, 1, 0], "position": [0, 300, 0], "distance": null}]})",
      "result.json");
  ASSERT_TRUE(lights) << lights.error().text;
  ASSERT_EQ(lights->size(), 2u);
  EXPECT_EQ((*lights)[0].direction, kUp);
  EXPECT_DOUBLE_EQ(RadToDeg((*lights)[0].direction_sigma), 0.5);
  EXPECT_EQ((*lights)[0].position.value(), Vector3d(0.0, 0.0, 900.0));
  EXPECT_EQ((*lights)[1].distance.value(), 300.0);
}

TEST(Against, OtherFilesAreRefused) {
  for (const char* text :
       {"{", "[]", "{}", R"({"lights": 3})", R"({"lights": [{}]})",
        R"({"lights": [{"direction": [0, 0, 0]}]})",
        R"({"lights": [{"direction": [0, 0, 1], "distance": -1}]})",
        R"({"lights": [{"direction": [0, 0, 1], "position_covariance": [1]}]})"}) {
    const auto lights = ReadStatedLights(text, "a.json");
    ASSERT_FALSE(lights) << text;
    EXPECT_EQ(lights.error().kind, ErrorKind::kInput);
    EXPECT_NE(lights.error().text.find("a.json"), std::string::npos) << lights.error().text;
  }
}

}  // namespace
}  // namespace turnlight::calib::calibrate::probe
