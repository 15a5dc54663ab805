// What pictures of one still scene at one exposure say, block by block: means, and the noise from
// differences of two pictures. A block is small enough to be evenly lit; nothing else of the scene
// needs to be known.
#pragma once

#include <array>
#include <cstddef>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

namespace turnlight::calib::calibrate::response {

inline constexpr double kRoundingVariance = 1.0 / 12.0;  // of whole DN, DN^2

// The pixels of one colour in a picture: all of a grey one, one channel of R, G, B, or one place of
// a Bayer mosaic's cells.
struct Plane {
  cv::Mat values;             // one channel, the picture's depth
  int channel = 1;            // 0 red, 1 green or grey, 2 blue
  std::array<int, 2> origin;  // of its first pixel in the picture: column, row
  int step = 1;               // between its pixels in the picture

  double PixelX(double column) const { return origin[0] + step * column; }
  double PixelY(double row) const { return origin[1] + step * row; }
};

// bayer: RGGB, BGGR, GRBG or GBRG, of pictures of one channel.
std::vector<Plane> PlanesOf(const cv::Mat& image, const std::optional<std::string>& bayer);
// "red", "green", "green (2nd)", "blue" or "grey".
std::string PlaneName(const std::vector<Plane>& planes, std::size_t plane);

struct Moments {
  double count = 0.0, mean = 0.0, variance = 0.0;
};
// Without what is beyond 6 sigma of the rest.
Moments RobustMoments(const std::vector<double>& values);

struct Block {
  std::size_t plane = 0, place = 0;  // place: of the grid, row by row
  double x = 0.0, y = 0.0;           // its centre in the picture, pixels
  double pixels = 0.0;               // how many, of one picture
  // DN, over all pictures; hot and dead pixels (beyond 6 sigma) do not count.
  double mean = 0.0;
  double spread = 0.0;             // variance over pixels and pictures, DN^2
  double low = 0.0, high = 0.0;    // 2 % and 98 % quantile, DN
  double middle = 0.0;             // median, DN
  std::optional<double> variance;  // of one picture's noise, with rounding, DN^2
  double differences = 0.0;        // that it is made of
};

struct Group {
  double exposure_us = 0.0;
  std::size_t pictures = 0;
  std::vector<Block> blocks;
  // The largest change of light between the two pictures of a pair, a factor less 1. It is taken
  // out of the differences.
  double flicker = 0.0;
};

// pictures: of one size and type, 8 or 16 bits. black: DN, about which the light changes.
// columns x rows blocks a plane; they are at least 8 x 8 pixels.
Group MeasureGroup(const std::vector<cv::Mat>& pictures, const std::optional<std::string>& bayer,
                   double exposure_us, double black, cv::Size grid);

}  // namespace turnlight::calib::calibrate::response
