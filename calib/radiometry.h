// What a digital number means: DN to linear radiance and back (design, section 2).
//
//   s = (DN - black) / (white - black), then the encoding's inverse, then s * (t_ref / t) *
//   10^(-(g - g_ref) / 20), divided by the white balance. Negative values are kept: the inverse
//   encodings continue odd-symmetrically below 0 (linear part for sRGB).
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <optional>

namespace turnlight::calib {

enum class Encoding { kLinear, kSrgb, kGamma };

struct Radiometry {
  Encoding encoding = Encoding::kLinear;
  double gamma = 2.2;                           // used by kGamma
  double black = 0.0;                           // DN of no light
  double white = 1.0;                           // DN of radiance 1; above black
  std::optional<double> saturation;             // DN from which a pixel is clipped; default white
  std::optional<double> reference_exposure_us;  // default: frame 0's
  std::optional<double> reference_gain_db;      // default: frame 0's, or 0
  std::array<double, 3> white_balance{1.0, 1.0, 1.0};  // R, G, B; positive

  double SaturationDn() const { return saturation.value_or(white); }
};

// Exposure and gain of one frame.
struct Exposure {
  std::optional<double> exposure_us;
  double gain_db = 0.0;
};

// The factor (t_ref / t) * 10^(-(g - g_ref) / 20) of a frame.
double ExposureFactor(const Radiometry& radiometry, const Exposure& exposure);

// A picture in linear radiance. Colour is in the order R, G, B.
struct LinearImage {
  cv::Mat radiance;     // CV_32FC1 or CV_32FC3, h x w
  cv::Mat1b saturated;  // 255 where any channel's DN >= saturation (or is not finite), else 0
};

// image: CV_8U, CV_16U or CV_32F with 1 or 3 channels (R, G, B), as decoded; values are DN.
LinearImage Linearise(const cv::Mat& image, const Radiometry& radiometry, const Exposure& exposure);

// The inverse: radiance (CV_32FC1 or CV_32FC3) to DN of depth CV_8U, CV_16U (rounded to nearest,
// clipped to the type) or CV_32F (not clipped).
cv::Mat Encode(const cv::Mat& radiance, const Radiometry& radiometry, const Exposure& exposure,
               int depth);

}  // namespace turnlight::calib
