#include "rig/sim/gige/pixel_format.h"

#include <algorithm>
#include <cmath>

namespace turnlight::rig::sim::gige {
namespace {

double FullScale(SensorDepth depth) {
  return depth == SensorDepth::k8 ? 255.0 : depth == SensorDepth::k16 ? 65535.0 : 1.0;
}

// Value by value, row by row.
template <typename T>
std::vector<T> Values(const cv::Mat& picture, PixelLayout layout, const cv::Rect& region) {
  std::vector<T> values;
  const int channels = picture.channels();
  values.reserve(static_cast<std::size_t>(region.area()) * 3);
  for (int y = region.y; y < region.y + region.height; ++y) {
    const T* row = picture.ptr<T>(y);
    for (int x = region.x; x < region.x + region.width; ++x) {
      const T* pixel = row + static_cast<std::ptrdiff_t>(x) * channels;
      if (layout == PixelLayout::kBayerRg)
        values.push_back(pixel[y % 2 + x % 2]);  // R G / G B
      else
        values.insert(values.end(), pixel, pixel + channels);
    }
  }
  return values;
}

std::vector<std::uint8_t> Bytes(const std::vector<std::uint16_t>& values, bool packed) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(2 * values.size());
  if (!packed) {
    for (const std::uint16_t value : values) {
      bytes.push_back(static_cast<std::uint8_t>(value & 0xFF));
      bytes.push_back(static_cast<std::uint8_t>(value >> 8));
    }
    return bytes;
  }
  for (std::size_t i = 0; i + 1 < values.size(); i += 2) {
    const std::uint16_t a = values[i], b = values[i + 1];
    bytes.push_back(static_cast<std::uint8_t>(a >> 4));
    bytes.push_back(static_cast<std::uint8_t>((b & 0xF) << 4 | (a & 0xF)));
    bytes.push_back(static_cast<std::uint8_t>(b >> 4));
  }
  return bytes;
}

}  // namespace

const std::array<PixelFormat, 8>& PixelFormats() {
  static constexpr std::array<PixelFormat, 8> kFormats{{
      {"Mono8", 0x01080001, 8, PixelLayout::kMono, false},
      {"Mono12", 0x01100005, 12, PixelLayout::kMono, false},
      {"Mono12Packed", 0x010C0006, 12, PixelLayout::kMono, true},
      {"Mono16", 0x01100007, 16, PixelLayout::kMono, false},
      {"BayerRG8", 0x01080009, 8, PixelLayout::kBayerRg, false},
      {"BayerRG12", 0x01100011, 12, PixelLayout::kBayerRg, false},
      {"BayerRG16", 0x0110002F, 16, PixelLayout::kBayerRg, false},
      {"RGB8", 0x02180014, 8, PixelLayout::kRgb, false},
  }};
  return kFormats;
}

std::vector<std::string> PixelFormatNames() {
  std::vector<std::string> names;
  for (const PixelFormat& format : PixelFormats()) names.emplace_back(format.name);
  return names;
}

const PixelFormat* FindPixelFormat(const std::string& name) {
  for (const PixelFormat& format : PixelFormats())
    if (name == format.name) return &format;
  return nullptr;
}

const PixelFormat* FindPixelFormat(std::uint32_t code) {
  for (const PixelFormat& format : PixelFormats())
    if (code == format.code) return &format;
  return nullptr;
}

calib::Radiometry RadiometryOf(const calib::Radiometry& studio, const Sensor& sensor,
                               const PixelFormat& format) {
  const double scale = ((1 << format.bits) - 1) / FullScale(sensor.depth);
  calib::Radiometry radiometry = studio;
  radiometry.black = std::round(studio.black * scale);
  radiometry.white = studio.white * scale;
  if (studio.saturation) radiometry.saturation = *studio.saturation * scale;
  return radiometry;
}

Sensor SensorOf(Sensor sensor, const PixelFormat& format) {
  sensor.depth = format.bits == 8 ? SensorDepth::k8 : SensorDepth::k16;
  return sensor;
}

std::vector<std::uint8_t> Pack(const cv::Mat& picture, const PixelFormat& format,
                               const cv::Rect& region) {
  if (format.bits == 8) return Values<std::uint8_t>(picture, format.layout, region);
  return Bytes(Values<std::uint16_t>(picture, format.layout, region), format.packed);
}

}  // namespace turnlight::rig::sim::gige
