// Linearity: which encoding the exposures of a still scene call for.
//
// A block of the scene sends E, and in the exposure t its linear share must be E t. Known exposure
// times and unknown E of many blocks determine the encoding (Debevec and Malik, 1997), without any
// knowledge of the scene. Linear, sRGB and a power are preferred to a curve of many numbers as long
// as they explain the pictures.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "calib/calibrate/response/blocks.h"
#include "calib/radiometry.h"

namespace turnlight::calib::calibrate::response {

struct BlackLevel {
  double dn = 0.0, sigma = 0.0;
};

// Of a sensor's dark frames: their mean, or where 0 cut their noise off the median, which does not
// see that. None without dark frames.
std::optional<BlackLevel> FindBlack(const std::vector<Group>& dark);

// The DN at which pixels stop to get brighter with the exposure, or to scatter. None if none did.
std::optional<double> FindSaturation(const std::vector<Group>& series, double black);

struct EncodingTrial {
  std::string name;    // "linear", "srgb", "gamma" or "curve"
  double chi = 0.0;    // root of chi^2 per degree of freedom: 1 is noise and 0.1 % of the light
  double worst = 0.0;  // largest deviation of a block's light, a share of it
};

// One block in one exposure, by the encoding that was chosen and as if it were linear.
struct LinearityPoint {
  double dn = 0.0;
  double deviation = 0.0, linear_deviation = 0.0;  // of the light, a share of it
  double sigma = 0.0;
};

struct ResponseCurve {
  Radiometry radiometry;  // encoding, black, white
  double black_sigma = 0.0;
  std::optional<double> gamma_sigma;
  std::vector<double> curve_sigma;  // of the linear shares of the curve's points
  std::vector<EncodingTrial> trials;
  bool explained = false;  // by what was taken
  std::vector<LinearityPoint> points;
};

// white: full scale, DN. saturation: what is brighter does not count. black: as known; else it is
// fitted. Fails (kInput) if too few blocks change with the exposure.
Result<ResponseCurve> FitResponseCurve(const std::vector<Group>& series,
                                       const std::optional<BlackLevel>& black, double white,
                                       double saturation);

}  // namespace turnlight::calib::calibrate::response
