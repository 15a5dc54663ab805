#include "rig/session/tiff_samples.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "base/format.h"

namespace turnlight::rig {
namespace {

constexpr double kMostExact = 16777216.0;  // 2^24, up to which a 32-bit float holds whole numbers

template <typename T>
T At(const unsigned char* bytes, std::size_t index) {
  T value;
  std::memcpy(&value, bytes + index * sizeof(T), sizeof(T));
  return value;
}

// From the highest bit of the first byte on.
unsigned PackedAt(const unsigned char* bytes, std::size_t index, int bits) {
  unsigned value = 0;
  for (int i = 0; i < bits; ++i) {
    const std::size_t bit = index * static_cast<std::size_t>(bits) + static_cast<std::size_t>(i);
    value = value << 1 | (bytes[bit / 8] >> (7 - bit % 8) & 1U);
  }
  return value;
}

double UnsignedAt(const unsigned char* bytes, std::size_t index, int bits) {
  switch (bits) {
    case 8:
      return bytes[index];
    case 16:
      return At<std::uint16_t>(bytes, index);
    case 32:
      return At<std::uint32_t>(bytes, index);
    default:
      return PackedAt(bytes, index, bits);
  }
}

double SignedAt(const unsigned char* bytes, std::size_t index, int bits) {
  return bits == 8    ? At<std::int8_t>(bytes, index)
         : bits == 16 ? At<std::int16_t>(bytes, index)
                      : At<std::int32_t>(bytes, index);
}

double FloatAt(const unsigned char* bytes, std::size_t index, int bits) {
  return bits == 16   ? static_cast<float>(At<cv::float16_t>(bytes, index))
         : bits == 32 ? At<float>(bytes, index)
                      : At<double>(bytes, index);
}

double SampleAt(const TiffLayout& layout, const unsigned char* bytes, std::size_t index) {
  switch (layout.sample) {
    case TiffSample::kUnsigned:
      return UnsignedAt(bytes, index, layout.bits);
    case TiffSample::kSigned:
      return SignedAt(bytes, index, layout.bits);
    default:
      return FloatAt(bytes, index, layout.bits);
  }
}

template <typename T>
Status Store(const TiffLayout& layout, const unsigned char* bytes, const TiffPlace& place,
             const std::string& file, cv::Mat& image) {
  const bool whole = layout.sample == TiffSample::kUnsigned || layout.sample == TiffSample::kSigned;
  const int stride = image.channels();
  T* out = image.ptr<T>(place.y) + place.x * stride + place.channel;
  std::size_t index = 0;
  for (int x = 0; x < place.count; ++x, out += stride)
    for (int c = 0; c < place.channels; ++c) {
      const double value = SampleAt(layout, bytes, index++);
      if (whole && std::abs(value) > kMostExact)
        return InputError(file + ": a TIFF of whole numbers of 32 bits, with the value " +
                          NumberText(value, 12) + " at pixel " + std::to_string(place.x + x) +
                          ", " + std::to_string(place.y) + ", allowed are up to 16777216");
      out[c] = static_cast<T>(value);
    }
  return {};
}

}  // namespace

Status StoreSamples(const TiffLayout& layout, const unsigned char* bytes, const TiffPlace& place,
                    const std::string& file, cv::Mat& image) {
  const bool as_it_is = place.channels == image.channels() &&
                        layout.bits == 8 * static_cast<int>(image.elemSize1()) &&
                        layout.sample != TiffSample::kSigned &&
                        (layout.sample != TiffSample::kUnsigned || layout.depth != CV_32F);
  if (as_it_is) {
    std::memcpy(image.ptr(place.y, place.x), bytes,
                static_cast<std::size_t>(place.count) * image.elemSize());
    return {};
  }
  switch (image.depth()) {
    case CV_8U:
      return Store<std::uint8_t>(layout, bytes, place, file, image);
    case CV_16U:
      return Store<std::uint16_t>(layout, bytes, place, file, image);
    default:
      return Store<float>(layout, bytes, place, file, image);
  }
}

void ResolveMask(TIFF* tiff, const TiffLayout& layout, cv::Mat& image) {
  if (!layout.palette && !layout.inverted) return;  // of at most 16 bits if it is either
  const int most = (1 << layout.bits) - 1;
  if (layout.palette) {
    std::uint16_t *red = nullptr, *green = nullptr, *blue = nullptr;
    cv::Mat1b table(1, 256, std::uint8_t{0});
    if (TIFFGetField(tiff, TIFFTAG_COLORMAP, &red, &green, &blue) == 1)
      for (int i = 0; i <= most; ++i) table(0, i) = red[i] || green[i] || blue[i] ? 255 : 0;
    cv::LUT(image, table, image);
  } else {
    cv::Mat grey;
    cv::extractChannel(image, grey, 0);
    cv::subtract(cv::Scalar(most), grey, grey);
    cv::insertChannel(grey, image, 0);
  }
}

void ResolveLogLuv(cv::Mat& image) {
  // ITU-R BT.709, white D65.
  const cv::Matx33f rgb_of_xyz(3.240479f, -1.537150f, -0.498535f, -0.969256f, 1.875992f, 0.041556f,
                               0.055648f, -0.204043f, 1.057311f);
  cv::transform(image, image, rgb_of_xyz);
}

}  // namespace turnlight::rig
