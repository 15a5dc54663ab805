// Vignetting from pictures of an evenly lit surface, and the white balance from a grey card.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "calib/calibrate/response/blocks.h"
#include "calib/radiometry.h"

namespace turnlight::calib::calibrate::response {

struct FlatField {
  Vignetting vignetting;
  std::vector<double> sigma;  // of its coefficients
  double corner_share = 1.0;  // of the light, in the darkest corner
  double corner_sigma = 0.0;
  double rms = 0.0;            // of what is left, a share of the light
  bool significant = false;    // else the flat frames are even, and nothing needs to be taken out
  bool center_known = false;   // else the picture's middle was taken
  cv::Mat1d measured, fitted;  // blocks of the first plane, shares of the centre's light
};

// flat: frames of one exposure or several. radiometry: encoding, black and white. size: of the
// pictures. Fails (kInput) if they are clipped or black.
Result<FlatField> FitVignetting(const std::vector<Group>& flat, const Radiometry& radiometry,
                                double saturation, cv::Size size, cv::Size grid);

struct WhiteBalance {
  std::array<double, 3> balance{1.0, 1.0, 1.0}, sigma{0.0, 0.0, 0.0};
};

// card: within every picture. Fails (kInput) if the card is clipped, black or of one colour only.
Result<WhiteBalance> FindWhiteBalance(const std::vector<cv::Mat>& pictures,
                                      const std::optional<std::string>& bayer, const cv::Rect& card,
                                      const Radiometry& radiometry, double saturation);

}  // namespace turnlight::calib::calibrate::response
