#include "base/plot/colours.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "base/angles.h"

namespace turnlight::plot {
namespace {

double EncodeSrgb(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

uchar ToByte(double share) {
  return static_cast<uchar>(std::lround(255.0 * std::clamp(share, 0.0, 1.0)));
}

// Oklab in polar form (Ottosson, "A perceptual color space for image processing", 2020) to sRGB.
cv::Vec3b FromOklab(double lightness, double chroma, double hue) {
  const double a = chroma * std::cos(hue);
  const double b = chroma * std::sin(hue);
  const auto cube = [](double x) { return x * x * x; };
  const double l = cube(lightness + 0.3963377774 * a + 0.2158037573 * b);
  const double m = cube(lightness - 0.1055613458 * a - 0.0638541728 * b);
  const double s = cube(lightness - 0.0894841775 * a - 1.2914855480 * b);
  return {ToByte(EncodeSrgb(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s)),
          ToByte(EncodeSrgb(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s)),
          ToByte(EncodeSrgb(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s))};
}

std::array<cv::Vec3b, 256> Inferno() {
  cv::Mat1b ramp(1, 256);
  for (int i = 0; i < 256; ++i) ramp(0, i) = static_cast<uchar>(i);
  cv::Mat3b bgr;
  cv::applyColorMap(ramp, bgr, cv::COLORMAP_INFERNO);
  std::array<cv::Vec3b, 256> colours;
  for (int i = 0; i < 256; ++i) colours[i] = {bgr(0, i)[2], bgr(0, i)[1], bgr(0, i)[0]};
  return colours;
}

}  // namespace

cv::Vec3b DivergingColour(double t) {
  if (std::isnan(t)) return kUnobserved;
  const double strength = std::min(std::abs(t), 1.0);
  const double hue = DegToRad(t < 0.0 ? 258.0 : 28.0);
  return FromOklab(1.0 - 0.55 * strength, 0.17 * std::sin(0.5 * CV_PI * strength), hue);
}

cv::Vec3b SequentialColour(double t) {
  static const std::array<cv::Vec3b, 256> kColors = Inferno();
  if (std::isnan(t)) return kUnseen;
  return kColors[static_cast<std::size_t>(std::lround(255.0 * std::clamp(t, 0.0, 1.0)))];
}

cv::Mat3b ToDisplay(const cv::Mat3f& radiance, double exposure, int enlarge) {
  // Encoded before it is enlarged: interpolating linear light would ring around highlights.
  cv::Mat3f encoded(radiance.size());
  for (int row = 0; row < radiance.rows; ++row) {
    for (int column = 0; column < radiance.cols; ++column) {
      for (int c = 0; c < 3; ++c) {
        const double shown = exposure * radiance(row, column)[c];
        encoded(row, column)[c] =
            std::isnan(shown) ? 0.0f
                              : static_cast<float>(255.0 * EncodeSrgb(std::clamp(shown, 0.0, 1.0)));
      }
    }
  }
  if (enlarge > 1) cv::resize(encoded, encoded, {}, enlarge, enlarge, cv::INTER_CUBIC);
  cv::Mat3b display;
  encoded.convertTo(display, CV_8U);
  return display;
}

}  // namespace turnlight::plot
