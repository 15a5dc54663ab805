// What a digital number means: DN to linear radiance and back (design, section 2).
//
//   s = (DN - black) / (white - black), then the encoding's inverse, then s * (t_ref / t) *
//   10^(-(g - g_ref) / 20), divided by the white balance and the vignetting's share. Negative
//   values are kept: the inverse encodings continue odd-symmetrically below 0 (linear part for
//   sRGB, the slope at its end for a curve).
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

namespace turnlight::calib {

enum class Encoding { kLinear, kSrgb, kGamma, kCurve };

// How much of the light of the centre reaches a pixel at (x, y):
//   share = 1 + sum_k coefficients[k] q^(k + 1),   q = ((x - center_x)^2 + (y - center_y)^2) / R^2.
// Known where q <= 1 only: pixels further out are not used. There the share is 0.05 to 2.
struct Vignetting {
  double center_x = 0.0, center_y = 0.0;  // pixels
  double radius = 1.0;                    // R, pixels; above 0
  std::vector<double> coefficients;       // 1 to 4

  double Share(double q) const;
  // Of a pixel; 0 beyond R.
  double ShareAt(double x, double y) const;
};
inline constexpr double kLeastShare = 0.05, kMostShare = 2.0;

// The noise of one value: in linear DN, (white - black) times the linear share, its variance is
//   read_noise_dn^2 + dn_per_electron * max(linear DN, 0)
// and besides that whole numbers are rounded: 1/12 DN^2 of what is stored.
struct NoiseModel {
  double read_noise_dn = 0.0;    // at least 0
  double dn_per_electron = 0.0;  // at least 0; not both 0
  // At which gain that is so; at another both are larger by its factor. Default: at every frame's.
  std::optional<double> gain_db;
};

struct Radiometry {
  Encoding encoding = Encoding::kLinear;
  double gamma = 2.2;  // used by kGamma
  // Used by kCurve: (share of white above black as stored, linear share), both strictly rising from
  // (0, 0) to (1, 1); a MonotoneCurve goes through them.
  std::vector<std::array<double, 2>> curve;
  double black = 0.0;                           // DN of no light
  double white = 1.0;                           // DN of radiance 1; above black
  std::optional<double> saturation;             // DN from which a pixel is clipped; default white
  std::optional<double> reference_exposure_us;  // default: frame 0's
  std::optional<double> reference_gain_db;      // default: frame 0's, or 0
  std::array<double, 3> white_balance{1.0, 1.0, 1.0};  // R, G, B; positive
  std::optional<Vignetting> vignetting;
  std::optional<NoiseModel> noise;

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
  cv::Mat radiance;  // CV_32FC1 or CV_32FC3, h x w
  // 255 where any channel's DN >= saturation (or is not finite) or the vignetting is not known,
  // else 0.
  cv::Mat1b saturated;
  // Of a value's noise, in radiance squared, the mean over the channels. Of the mean of the 24
  // pixels around it: with its own value, those that noise made dark would count for more. Empty
  // without radiometry.noise.
  cv::Mat1f variance;
};

// image: CV_8U, CV_16U or CV_32F with 1 or 3 channels (R, G, B), as decoded; values are DN.
LinearImage Linearise(const cv::Mat& image, const Radiometry& radiometry, const Exposure& exposure);

// The inverse: radiance (CV_32FC1 or CV_32FC3) to DN of depth CV_8U, CV_16U (rounded to nearest,
// clipped to the type) or CV_32F (not clipped).
cv::Mat Encode(const cv::Mat& radiance, const Radiometry& radiometry, const Exposure& exposure,
               int depth);

}  // namespace turnlight::calib
