// Proves: of simulated exposure series of an unevenly lit scene the encoding is recognised and
// recovered within 0.5 %, for 8 and 12 bits, with and without dark frames; black and saturation are
// found; what is not enough is refused. Does not prove anything about lamps that drift with the
// exposure: no series tells those from a curve.
#include "calib/calibrate/response/response_curve.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/calib/calibrate/response/fitted.h"

namespace turnlight::calib::calibrate::response {
namespace {

using testing::HasSubstr;

SimulatedSensor Gamma8(double black) {
  SimulatedSensor sensor;
  sensor.bits = 8;
  sensor.black = black;
  sensor.saturation = 255.0;
  sensor.encode = [](double x) { return std::pow(x, 1.0 / 2.2); };
  return sensor;
}

TEST(ResponseCurve, ALinearSensorIsLinear) {
  SimulatedSensor sensor;
  sensor.hot = 0.001;
  const auto fit = FitSeries(sensor, TakeSeries(sensor, 1));
  ASSERT_TRUE(fit) << fit.error().text;
  EXPECT_EQ(fit->curve.radiometry.encoding, Encoding::kLinear);
  EXPECT_TRUE(fit->curve.explained);
  EXPECT_NEAR(fit->curve.radiometry.black, 64.0, 4.0 * fit->curve.black_sigma);
}

TEST(ResponseCurve, Gamma) {
  for (const double black : {0.0, 10.0})
    for (const bool dark : {true, false}) {
      const SimulatedSensor sensor = Gamma8(black);
      const auto fit = FitSeries(sensor, TakeSeries(sensor, 2), dark);
      ASSERT_TRUE(fit) << fit.error().text;
      ASSERT_EQ(fit->curve.radiometry.encoding, Encoding::kGamma);
      EXPECT_NEAR(fit->curve.radiometry.gamma, 2.2, 0.005 * 2.2);
      EXPECT_NEAR(fit->curve.radiometry.gamma, 2.2, 4.0 * *fit->curve.gamma_sigma);
      EXPECT_NEAR(fit->curve.radiometry.black, black, 0.1);
      EXPECT_LT(CurveError(sensor, fit->curve), 0.005);
    }
}

TEST(ResponseCurve, Srgb) {
  SimulatedSensor sensor = Gamma8(0.0);
  sensor.encode = [](double r) {
    return r <= 0.04045 / 12.92 ? r * 12.92 : 1.055 * std::pow(r, 1.0 / 2.4) - 0.055;
  };
  const auto fit = FitSeries(sensor, TakeSeries(sensor, 1));
  ASSERT_TRUE(fit) << fit.error().text;
  EXPECT_LT(CurveError(sensor, fit->curve), 0.005);
  EXPECT_EQ(fit->curve.radiometry.encoding, Encoding::kSrgb);
}

// Mildly bent, with a knee, and as logarithmic cameras are.
TEST(ResponseCurve, OtherCurves) {
  const std::function<double(double)> encodings[] = {
      [](double x) { return x + 0.04 * x * (1.0 - x); }, [](double x) { return x - 0.03 * x * x; },
      [](double x) { return x < 0.7 ? x : x - 0.6 * (x - 0.7) * (x - 0.7); },
      [](double x) { return std::log1p(50.0 * x) / std::log1p(50.0); }};
  for (const auto& encoding : encodings) {
    SimulatedSensor sensor;
    sensor.encode = encoding;
    const auto fit = FitSeries(sensor, TakeSeries(sensor, 3));
    ASSERT_TRUE(fit) << fit.error().text;
    EXPECT_LT(CurveError(sensor, fit->curve), 0.005) << encoding(0.5);
    EXPECT_EQ(fit->curve.radiometry.encoding, Encoding::kCurve) << encoding(0.5);
    EXPECT_TRUE(fit->curve.explained);
  }
}

TEST(ResponseCurve, SaturationIsWhereClippingBegins) {
  SimulatedSensor sensor;
  for (const double saturation : {4095.0, 3600.0}) {
    sensor.saturation = saturation;
    EXPECT_EQ(FindSaturation(TakeSeries(sensor, 1).series, sensor.black), saturation);
  }
  Series dim = TakeSeries(sensor, 1);
  dim.series.resize(10);
  EXPECT_FALSE(FindSaturation(dim.series, sensor.black));
}

TEST(ResponseCurve, ALampThatDriftsIsToldFromACurve) {
  SimulatedSensor sensor;
  Series taken = TakeSeries(sensor, 1);
  for (std::size_t i = 0; i < taken.series.size(); i += 3) taken.series[i].exposure_us *= 1.02;
  const auto fit = FitSeries(sensor, taken);
  ASSERT_TRUE(fit) << fit.error().text;
  EXPECT_FALSE(fit->curve.explained);
}

TEST(ResponseCurve, BlackOfCutOffNoise) {
  SimulatedSensor sensor;
  sensor.black = 0.0;
  const auto black = FindBlack(TakeSeries(sensor, 1).dark);
  ASSERT_TRUE(black);
  EXPECT_EQ(black->dn, 0.0) << "not the mean of what is left, about 0.8";
  EXPECT_FALSE(FindBlack({}));
}

TEST(ResponseCurve, TooLittleIsRefused) {
  SimulatedSensor sensor;
  Series taken = TakeSeries(sensor, 1);
  taken.series.resize(1);
  const auto fit = FitResponseCurve(taken.series, std::nullopt, 4095.0, 4095.0);
  ASSERT_FALSE(fit);
  EXPECT_THAT(fit.error().text, HasSubstr("allowed is a scene whose brightness follows"));
}

}  // namespace
}  // namespace turnlight::calib::calibrate::response
