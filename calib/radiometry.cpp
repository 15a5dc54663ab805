#include "calib/radiometry.h"

#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <vector>

#include "base/parallel.h"

namespace turnlight::calib {
namespace {

// IEC 61966-2-1. The linear part goes on below 0.
constexpr double kSrgbKnee = 0.04045;
constexpr double kSrgbSlope = 12.92;

double Decode(double s, const Radiometry& radiometry) {
  switch (radiometry.encoding) {
    case Encoding::kLinear:
      return s;
    case Encoding::kSrgb:
      return s <= kSrgbKnee ? s / kSrgbSlope : std::pow((s + 0.055) / 1.055, 2.4);
    case Encoding::kGamma:
      return std::copysign(std::pow(std::abs(s), radiometry.gamma), s);
  }
  return s;
}

double EncodeUnit(double r, const Radiometry& radiometry) {
  switch (radiometry.encoding) {
    case Encoding::kLinear:
      return r;
    case Encoding::kSrgb:
      return r <= kSrgbKnee / kSrgbSlope ? r * kSrgbSlope : 1.055 * std::pow(r, 1.0 / 2.4) - 0.055;
    case Encoding::kGamma:
      return std::copysign(std::pow(std::abs(r), 1.0 / radiometry.gamma), r);
  }
  return r;
}

// Grey pictures are balanced as green, the channel that grey sensors resemble most.
double WhiteBalance(const Radiometry& radiometry, int channels, int channel) {
  return radiometry.white_balance[static_cast<std::size_t>(channels == 1 ? 1 : channel)];
}

double RadianceOfDn(double dn, const Radiometry& radiometry, double scale) {
  return Decode((dn - radiometry.black) / (radiometry.white - radiometry.black), radiometry) *
         scale;
}

// The radiance of each digital number, per channel: row c, column DN. T is 8 or 16 bits.
template <typename T>
std::vector<std::vector<float>> Tables(const Radiometry& radiometry, double factor, int channels) {
  constexpr std::size_t kCount = std::size_t{1} << (8 * sizeof(T));
  std::vector<std::vector<float>> tables(static_cast<std::size_t>(channels),
                                         std::vector<float>(kCount));
  for (std::size_t dn = 0; dn < kCount; ++dn) {
    const double radiance = RadianceOfDn(static_cast<double>(dn), radiometry, factor);
    for (int c = 0; c < channels; ++c)
      tables[static_cast<std::size_t>(c)][dn] =
          static_cast<float>(radiance / WhiteBalance(radiometry, channels, c));
  }
  return tables;
}

template <typename T>
void LineariseIntegers(const cv::Mat& image, const Radiometry& radiometry, double factor,
                       LinearImage& out) {
  const int channels = image.channels();
  const auto tables = Tables<T>(radiometry, factor, channels);
  const double saturation = radiometry.SaturationDn();
  ParallelFor(static_cast<std::size_t>(image.rows), [&](std::size_t index) {
    const int row = static_cast<int>(index);
    const T* in = image.ptr<T>(row);
    float* radiance = out.radiance.ptr<float>(row);
    std::uint8_t* saturated = out.saturated.ptr<std::uint8_t>(row);
    for (int x = 0; x < image.cols; ++x) {
      bool clipped = false;
      for (int c = 0; c < channels; ++c) {
        const T dn = in[x * channels + c];
        radiance[x * channels + c] = tables[static_cast<std::size_t>(c)][dn];
        clipped |= static_cast<double>(dn) >= saturation;
      }
      saturated[x] = clipped ? 255 : 0;
    }
  });
}

// A value that is not finite, before or after scaling, becomes 0 and flagged: it must not spread
// into sums that forget to look at the flag.
void LineariseFloats(const cv::Mat& image, const Radiometry& radiometry, double factor,
                     LinearImage& out) {
  const int channels = image.channels();
  const double saturation = radiometry.SaturationDn();
  ParallelFor(static_cast<std::size_t>(image.rows), [&](std::size_t index) {
    const int row = static_cast<int>(index);
    const float* in = image.ptr<float>(row);
    float* radiance = out.radiance.ptr<float>(row);
    std::uint8_t* saturated = out.saturated.ptr<std::uint8_t>(row);
    for (int x = 0; x < image.cols; ++x) {
      bool clipped = false;
      for (int c = 0; c < channels; ++c) {
        const double dn = in[x * channels + c];
        const auto value = static_cast<float>(RadianceOfDn(dn, radiometry, factor) /
                                              WhiteBalance(radiometry, channels, c));
        const bool usable = std::isfinite(dn) && std::isfinite(value);
        radiance[x * channels + c] = usable ? value : 0.0f;
        clipped |= !usable || dn >= saturation;
      }
      saturated[x] = clipped ? 255 : 0;
    }
  });
}

// Rounds to nearest and clips; NaN becomes 0.
template <typename T>
T ToDn(double dn) {
  if constexpr (std::is_floating_point_v<T>) {
    return static_cast<T>(dn);
  } else {
    constexpr double kMax = std::numeric_limits<T>::max();
    if (!(dn > 0.0)) return 0;
    return dn >= kMax ? std::numeric_limits<T>::max() : static_cast<T>(std::floor(dn + 0.5));
  }
}

template <typename T>
void EncodeRows(const cv::Mat& radiance, const Radiometry& radiometry, double factor,
                cv::Mat& out) {
  const int channels = radiance.channels();
  ParallelFor(static_cast<std::size_t>(radiance.rows), [&](std::size_t index) {
    const int row = static_cast<int>(index);
    const float* in = radiance.ptr<float>(row);
    T* dn = out.ptr<T>(row);
    for (int i = 0; i < radiance.cols * channels; ++i) {
      const double balance = WhiteBalance(radiometry, channels, i % channels);
      const double s = EncodeUnit(in[i] * balance / factor, radiometry);
      dn[i] = ToDn<T>(radiometry.black + s * (radiometry.white - radiometry.black));
    }
  });
}

}  // namespace

double ExposureFactor(const Radiometry& radiometry, const Exposure& exposure) {
  const double gain = exposure.gain_db - radiometry.reference_gain_db.value_or(0.0);
  const double time = radiometry.reference_exposure_us && exposure.exposure_us
                          ? *radiometry.reference_exposure_us / *exposure.exposure_us
                          : 1.0;
  return time * std::pow(10.0, -gain / 20.0);
}

LinearImage Linearise(const cv::Mat& image, const Radiometry& radiometry,
                      const Exposure& exposure) {
  const int channels = image.channels();
  assert(channels == 1 || channels == 3);
  LinearImage out;
  out.radiance.create(image.rows, image.cols, CV_32FC(channels));
  out.saturated.create(image.rows, image.cols);
  const double factor = ExposureFactor(radiometry, exposure);
  switch (image.depth()) {
    case CV_8U:
      LineariseIntegers<std::uint8_t>(image, radiometry, factor, out);
      break;
    case CV_16U:
      LineariseIntegers<std::uint16_t>(image, radiometry, factor, out);
      break;
    case CV_32F:
      LineariseFloats(image, radiometry, factor, out);
      break;
    default:
      assert(false && "depth is CV_8U, CV_16U or CV_32F");
  }
  return out;
}

cv::Mat Encode(const cv::Mat& radiance, const Radiometry& radiometry, const Exposure& exposure,
               int depth) {
  assert(radiance.depth() == CV_32F && (radiance.channels() == 1 || radiance.channels() == 3));
  cv::Mat out(radiance.rows, radiance.cols, CV_MAKETYPE(depth, radiance.channels()));
  const double factor = ExposureFactor(radiometry, exposure);
  switch (depth) {
    case CV_8U:
      EncodeRows<std::uint8_t>(radiance, radiometry, factor, out);
      break;
    case CV_16U:
      EncodeRows<std::uint16_t>(radiance, radiometry, factor, out);
      break;
    case CV_32F:
      EncodeRows<float>(radiance, radiometry, factor, out);
      break;
    default:
      assert(false && "depth is CV_8U, CV_16U or CV_32F");
  }
  return out;
}

}  // namespace turnlight::calib
