// The pixel formats that the simulated camera streams, and how a picture becomes their bytes.
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "calib/radiometry.h"
#include "rig/sim/synthetic_config.h"

namespace turnlight::rig::sim::gige {

enum class PixelLayout { kMono, kBayerRg, kRgb };

struct PixelFormat {
  const char* name;    // of the SFNC
  std::uint32_t code;  // of the PFNC; GigE Vision's of Mono12Packed
  int bits;  // of a value; those above 8 take two bytes, the lower one first, unless packed
  PixelLayout layout;
  bool packed;  // two values of 12 bits in three bytes
};

const std::array<PixelFormat, 8>& PixelFormats();
std::vector<std::string> PixelFormatNames();
// Null if there is none.
const PixelFormat* FindPixelFormat(const std::string& name);
const PixelFormat* FindPixelFormat(std::uint32_t code);

// What the DN of a format mean: black, white and saturation are the same shares of the range as the
// sensor's, black in whole DN. By default white is 2^bits - 1.
calib::Radiometry RadiometryOf(const calib::Radiometry& studio, const Sensor& sensor,
                               const PixelFormat& format);
// The sensor with the depth of a format's pictures, 8 or 16 bits.
Sensor SensorOf(Sensor sensor, const PixelFormat& format);

// The bytes of a region of a picture: CV_8U or CV_16U as SensorOf says, one channel for mono, else
// R, G, B. Of a mosaic each pixel keeps one channel, by its place on the sensor: red where row and
// column are even. The region's corner and size must be even.
std::vector<std::uint8_t> Pack(const cv::Mat& picture, const PixelFormat& format,
                               const cv::Rect& region);

}  // namespace turnlight::rig::sim::gige
