// Proves: gain and read noise of simulated sensors are found within their sigmas, through an
// encoding too, with hot pixels and flicker; what is clipped or too quiet does not count. The
// sigmas themselves the study checks (response_study).
#include "calib/calibrate/response/photon_transfer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/calib/calibrate/response/fitted.h"

namespace turnlight::calib::calibrate::response {
namespace {

using testing::HasSubstr;

void ExpectFound(const SimulatedSensor& sensor, double drift = 0.0) {
  const auto fit = FitSeries(sensor, TakeSeries(sensor, 5, {160, 120}, drift));
  ASSERT_TRUE(fit) << fit.error().text;
  const PhotonTransfer& transfer = fit->transfer;
  EXPECT_NEAR(transfer.dn_per_electron, sensor.Gain(), 3.0 * transfer.GainSigma());
  EXPECT_NEAR(transfer.read_noise_dn, sensor.Gain() * sensor.read_electrons,
              3.0 * transfer.ReadSigma());
  EXPECT_LT(transfer.GainSigma(), 0.02 * sensor.Gain());
  EXPECT_NEAR(transfer.chi, 1.0, 0.2);
}

TEST(PhotonTransfer, OfALinearSensor) { ExpectFound(SimulatedSensor{}); }

TEST(PhotonTransfer, WithHotPixelsAndFlicker) {
  SimulatedSensor sensor;
  sensor.hot = 0.001;
  sensor.prnu = 0.02;
  ExpectFound(sensor, 0.02);
}

TEST(PhotonTransfer, ThroughAnEncoding) {
  SimulatedSensor sensor;
  sensor.bits = 8;
  sensor.black = 0.0;
  sensor.saturation = 255.0;
  sensor.encode = [](double x) { return std::pow(x, 1.0 / 2.2); };
  ExpectFound(sensor);
}

TEST(PhotonTransfer, WithoutPairsOrNoiseItIsRefused) {
  SimulatedSensor sensor;
  Series taken = TakeSeries(sensor, 1);
  for (Group& group : taken.series) group.pictures = 1;
  Radiometry radiometry;
  radiometry.black = 64.0;
  radiometry.white = 4095.0;
  const auto alone = FitPhotonTransfer(taken.series, {}, radiometry, 0.1, 4095.0);
  ASSERT_FALSE(alone);
  EXPECT_THAT(alone.error().text, HasSubstr("0 exposures have two pictures"));
  // 8 bits and a million electrons: rounding hides all noise.
  sensor.bits = 8;
  sensor.black = 5.0;
  sensor.saturation = 255.0;
  sensor.full_well = 1e6;
  radiometry.black = 5.0;
  radiometry.white = 255.0;
  const auto quiet = FitPhotonTransfer(TakeSeries(sensor, 1).series, {}, radiometry, 0.1, 255.0);
  ASSERT_FALSE(quiet);
  EXPECT_THAT(quiet.error().text, HasSubstr("rounded away"));
}

}  // namespace
}  // namespace turnlight::calib::calibrate::response
