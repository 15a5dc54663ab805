// A simulated sensor's exposure series, measured and fitted.
#pragma once

#include <vector>

#include "calib/calibrate/response/photon_transfer.h"
#include "calib/calibrate/response/response_curve.h"
#include "calib/transfer.h"
#include "tests/calib/calibrate/response/sensor.h"

namespace turnlight::calib::calibrate::response {

inline const cv::Size kTestGrid(8, 6);

struct Series {
  std::vector<Group> series, dark;
};

// Pairs of a ramp at exposures from 1/64 to 1.4 of what fills its brightest part, and four dark
// frames.
inline Series TakeSeries(const SimulatedSensor& sensor, std::uint64_t seed,
                         cv::Size size = {160, 120}, double drift = 0.0) {
  const cv::Mat1d scene = Ramp(size, 0.3, 1.0);
  const cv::Mat1d nothing(size, 0.0);
  Series out;
  std::uint64_t picture = seed * 1000;
  std::vector<cv::Mat> dark;
  for (int i = 0; i < 4; ++i) dark.push_back(Expose(sensor, nothing, 0.0, ++picture));
  out.dark.push_back(MeasureGroup(dark, std::nullopt, 0.0, 0.0, kTestGrid));
  for (double exposure = 1.0 / 64.0; exposure < 1.5; exposure *= std::sqrt(2.0)) {
    const cv::Mat a = Expose(sensor, scene, exposure, ++picture),
                  b = Expose(sensor, scene, exposure * (1.0 + drift), ++picture);
    out.series.push_back(
        MeasureGroup({a, b}, std::nullopt, 1000.0 * exposure, sensor.black, kTestGrid));
  }
  return out;
}

struct Fitted {
  ResponseCurve curve;
  PhotonTransfer transfer;
  double saturation = 0.0;
  std::optional<BlackLevel> black;
};

inline Result<Fitted> FitSeries(const SimulatedSensor& sensor, const Series& taken,
                                bool with_dark = true) {
  Fitted out;
  if (with_dark) out.black = FindBlack(taken.dark);
  out.saturation = FindSaturation(taken.series, sensor.black).value_or(sensor.White());
  auto curve = FitResponseCurve(taken.series, out.black, sensor.White(), out.saturation);
  if (!curve) return Forward(curve);
  out.curve = *curve;
  auto transfer = FitPhotonTransfer(taken.series, taken.dark, curve->radiometry, curve->black_sigma,
                                    out.saturation);
  if (!transfer) return Forward(transfer);
  out.transfer = *transfer;
  return out;
}

// The largest error of the linear share of what the sensor stores, over 5 % to 95 % of white, once
// its scale, which no series tells, is the best; as a share of white.
inline double CurveError(const SimulatedSensor& sensor, const ResponseCurve& curve) {
  const Transfer transfer(curve.radiometry);
  const double range = curve.radiometry.white - curve.radiometry.black;
  double product = 0.0, square = 0.0, worst = 0.0;
  const auto found = [&](double x) {
    const double dn = sensor.black + (sensor.White() - sensor.black) * sensor.encode(x);
    return transfer.Decode((dn - curve.radiometry.black) / range);
  };
  for (double x = 0.02; x < 0.96; x += 0.01) {
    product += x * found(x);
    square += found(x) * found(x);
  }
  for (double x = 0.02; x < 0.96; x += 0.01)
    worst = std::max(worst, std::abs(product / square * found(x) - x));
  return worst;
}

}  // namespace turnlight::calib::calibrate::response
