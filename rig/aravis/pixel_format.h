// Pixel formats of GigE Vision and USB3 Vision (PFNC), and how their bytes become pictures.
//
//   Mono8, BayerRG8, RGB8         a byte per value
//   Mono10/12/14/16, BayerRG10..  two bytes per value, little-endian, the value in the low bits
//   Mono10p, Mono12p              a stream of bits without gaps, the lowest bit first
//   Mono10Packed, Mono12Packed    two pixels in three bytes: the high eight bits of each in the
//   first
//                                 and third, their low bits in the halves of the second, the first
//                                 pixel's in the lower
//
// and the same for BayerGR, BayerRG, BayerGB and BayerBG. RGB8 and BGR8 come out as R, G, B; a
// mosaic stays one channel. Values are never scaled.
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace turnlight::rig::aravis {

enum class PixelLayout { kBytes, kWords, kBitStream, kPairInThreeBytes, kReversedBytes };

struct PixelFormat {
  std::string name;        // of PFNC, "BayerRG12p"
  std::uint32_t code = 0;  // of PFNC
  int bits = 8;            // of a value: 8, 10, 12, 14 or 16
  PixelLayout layout = PixelLayout::kBytes;
  std::optional<std::string> bayer;  // RGGB, BGGR, GRBG or GBRG

  int Channels() const;  // 1 or 3
  int Depth() const { return bits > 8 ? CV_16U : CV_8U; }
  double MaxDn() const { return (1 << bits) - 1; }
  int BitsPerPixel() const { return static_cast<int>(code >> 16 & 0xff); }  // in the stream
};

std::optional<PixelFormat> FindPixelFormat(std::string_view name);
std::vector<std::string> PixelFormatNames();

// The picture of these bytes: rows one after the other without gaps in a packed layout, but for
// row_padding bytes behind each row (then every row begins at a byte). Fails (kDevice) if they are
// too few, or if a value is beyond the format's bits.
Result<cv::Mat> Unpack(std::span<const std::uint8_t> bytes, cv::Size size, int row_padding,
                       const PixelFormat& format);

}  // namespace turnlight::rig::aravis
