#include "rig/aravis/pixel_format.h"

#include <algorithm>
#include <utility>

namespace turnlight::rig::aravis {
namespace {

// The first two letters of a mosaic's first row stand in its PFNC name, OpenCV's and ours says both
// rows.
struct Mosaic {
  const char* row;
  const char* pattern;
  // The code's last byte for 8, 10, 12, 16, 10p, 12p, 10Packed and 12Packed.
  std::array<std::uint32_t, 8> codes;
};
constexpr Mosaic kMosaics[] = {{"GR", "GRBG", {0x08, 0x0c, 0x10, 0x2e, 0x56, 0x57, 0x26, 0x2a}},
                               {"RG", "RGGB", {0x09, 0x0d, 0x11, 0x2f, 0x58, 0x59, 0x27, 0x2b}},
                               {"GB", "GBRG", {0x0a, 0x0e, 0x12, 0x30, 0x54, 0x55, 0x28, 0x2c}},
                               {"BG", "BGGR", {0x0b, 0x0f, 0x13, 0x31, 0x52, 0x53, 0x29, 0x2d}}};
struct MosaicDepth {
  const char* suffix;
  std::uint32_t code;  // without its last byte: one channel, bits per pixel in the stream
  int bits;
  PixelLayout layout;
};
constexpr MosaicDepth kMosaicDepths[] = {
    {"8", 0x01080000, 8, PixelLayout::kBytes},
    {"10", 0x01100000, 10, PixelLayout::kWords},
    {"12", 0x01100000, 12, PixelLayout::kWords},
    {"16", 0x01100000, 16, PixelLayout::kWords},
    {"10p", 0x010a0000, 10, PixelLayout::kBitStream},
    {"12p", 0x010c0000, 12, PixelLayout::kBitStream},
    {"10Packed", 0x010c0000, 10, PixelLayout::kPairInThreeBytes},
    {"12Packed", 0x010c0000, 12, PixelLayout::kPairInThreeBytes}};

std::vector<PixelFormat> MakeFormats() {
  std::vector<PixelFormat> formats = {
      {"Mono8", 0x01080001, 8, PixelLayout::kBytes, std::nullopt},
      {"Mono10", 0x01100003, 10, PixelLayout::kWords, std::nullopt},
      {"Mono12", 0x01100005, 12, PixelLayout::kWords, std::nullopt},
      {"Mono14", 0x01100025, 14, PixelLayout::kWords, std::nullopt},
      {"Mono16", 0x01100007, 16, PixelLayout::kWords, std::nullopt},
      {"Mono10p", 0x010a0046, 10, PixelLayout::kBitStream, std::nullopt},
      {"Mono12p", 0x010c0047, 12, PixelLayout::kBitStream, std::nullopt},
      {"Mono10Packed", 0x010c0004, 10, PixelLayout::kPairInThreeBytes, std::nullopt},
      {"Mono12Packed", 0x010c0006, 12, PixelLayout::kPairInThreeBytes, std::nullopt},
      {"RGB8", 0x02180014, 8, PixelLayout::kBytes, std::nullopt},
      {"BGR8", 0x02180015, 8, PixelLayout::kReversedBytes, std::nullopt}};
  for (const Mosaic& mosaic : kMosaics)
    for (std::size_t i = 0; i < mosaic.codes.size(); ++i) {
      const MosaicDepth& depth = kMosaicDepths[i];
      formats.push_back({std::string("Bayer") + mosaic.row + depth.suffix,
                         depth.code | mosaic.codes[i], depth.bits, depth.layout, mosaic.pattern});
    }
  return formats;
}

const std::vector<PixelFormat>& Formats() {
  static const std::vector<PixelFormat> kFormats = MakeFormats();
  return kFormats;
}

// The value of number index in a run of values that begins at the first byte.
std::uint16_t ValueAt(const std::uint8_t* bytes, std::size_t index, const PixelFormat& format) {
  const auto bits = static_cast<std::size_t>(format.bits);
  switch (format.layout) {
    case PixelLayout::kWords:
      return static_cast<std::uint16_t>(bytes[2 * index] | bytes[2 * index + 1] << 8);
    case PixelLayout::kBitStream: {
      // 10 and 12 bits never reach into a third byte.
      const std::size_t at = index * bits;
      const int word = bytes[at / 8] | bytes[at / 8 + 1] << 8;
      return static_cast<std::uint16_t>(word >> at % 8 & ((1 << bits) - 1));
    }
    case PixelLayout::kPairInThreeBytes: {
      const std::uint8_t* pair = bytes + index / 2 * 3;
      const int high = index % 2 == 0 ? pair[0] : pair[2];
      const int low = index % 2 == 0 ? pair[1] : pair[1] >> 4;
      const int low_bits = format.bits - 8;
      return static_cast<std::uint16_t>(high << low_bits | (low & ((1 << low_bits) - 1)));
    }
    case PixelLayout::kBytes:
    case PixelLayout::kReversedBytes:
      break;
  }
  return bytes[index];
}

// Bytes of a run of so many pixels. In pairs of three bytes a single pixel at the end has two.
std::size_t BytesOf(std::size_t pixels, const PixelFormat& format) {
  if (format.layout == PixelLayout::kPairInThreeBytes) return (pixels * 3 + 1) / 2;
  return (pixels * static_cast<std::size_t>(format.BitsPerPixel()) + 7) / 8;
}

void UnpackRun(const std::uint8_t* bytes, std::size_t pixels, const PixelFormat& format,
               std::size_t first, cv::Mat& picture) {
  const auto channels = static_cast<std::size_t>(format.Channels());
  const std::size_t from = first * channels;
  if (picture.depth() == CV_16U) {
    std::uint16_t* out = picture.ptr<std::uint16_t>() + from;
    for (std::size_t i = 0; i < pixels; ++i) out[i] = ValueAt(bytes, i, format);
    return;
  }
  std::uint8_t* out = picture.ptr<std::uint8_t>() + from;
  std::copy_n(bytes, pixels * channels, out);
  if (format.layout == PixelLayout::kReversedBytes)
    for (std::size_t i = 0; i < pixels; ++i) std::swap(out[3 * i], out[3 * i + 2]);
}

}  // namespace

int PixelFormat::Channels() const { return code >> 24 == 2 ? 3 : 1; }

std::optional<PixelFormat> FindPixelFormat(std::string_view name) {
  for (const PixelFormat& format : Formats())
    if (format.name == name) return format;
  return std::nullopt;
}

std::vector<std::string> PixelFormatNames() {
  std::vector<std::string> names;
  for (const PixelFormat& format : Formats()) names.push_back(format.name);
  return names;
}

Result<cv::Mat> Unpack(std::span<const std::uint8_t> bytes, cv::Size size, int row_padding,
                       const PixelFormat& format) {
  const auto width = static_cast<std::size_t>(size.width);
  const auto height = static_cast<std::size_t>(size.height);
  const bool by_rows = row_padding > 0;
  const std::size_t row = BytesOf(width, format) + static_cast<std::size_t>(row_padding);
  const std::size_t needed = by_rows ? row * height - static_cast<std::size_t>(row_padding)
                                     : BytesOf(width * height, format);
  if (bytes.size() < needed)
    return DeviceError("a picture of " + std::to_string(bytes.size()) + " bytes, " + format.name +
                       " of " + std::to_string(size.width) + " x " + std::to_string(size.height) +
                       " has " + std::to_string(needed));
  cv::Mat picture(size, CV_MAKETYPE(format.Depth(), format.Channels()));
  if (by_rows) {
    for (std::size_t y = 0; y < height; ++y)
      UnpackRun(bytes.data() + y * row, width, format, y * width, picture);
  } else {
    UnpackRun(bytes.data(), width * height, format, 0, picture);
  }
  double highest = 0.0;
  if (format.layout == PixelLayout::kWords && format.bits < 16)
    cv::minMaxLoc(picture, nullptr, &highest);
  if (highest > format.MaxDn())
    return DeviceError("a value of " + std::to_string(static_cast<int>(highest)) +
                       " in a picture of " + format.name + ", allowed is at most " +
                       std::to_string(static_cast<int>(format.MaxDn())));
  return picture;
}

}  // namespace turnlight::rig::aravis
