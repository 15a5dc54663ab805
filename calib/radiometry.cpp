#include "calib/radiometry.h"

#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <vector>

#include "base/parallel.h"
#include "calib/transfer.h"

namespace turnlight::calib {
namespace {

// Grey pictures are balanced as green, the channel that grey sensors resemble most.
double WhiteBalance(const Radiometry& radiometry, int channels, int channel) {
  return radiometry.white_balance[static_cast<std::size_t>(channels == 1 ? 1 : channel)];
}

double RadianceOfDn(double dn, const Radiometry& radiometry, const Transfer& transfer,
                    double scale) {
  return transfer.Decode((dn - radiometry.black) / (radiometry.white - radiometry.black)) * scale;
}

// The radiance of each digital number, per channel: row c, column DN. T is 8 or 16 bits.
template <typename T>
std::vector<std::vector<float>> Tables(const Radiometry& radiometry, double factor, int channels) {
  constexpr std::size_t kCount = std::size_t{1} << (8 * sizeof(T));
  std::vector<std::vector<float>> tables(static_cast<std::size_t>(channels),
                                         std::vector<float>(kCount));
  const Transfer transfer(radiometry);
  for (std::size_t dn = 0; dn < kCount; ++dn) {
    const double radiance = RadianceOfDn(static_cast<double>(dn), radiometry, transfer, factor);
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
  const Transfer transfer(radiometry);
  ParallelFor(static_cast<std::size_t>(image.rows), [&](std::size_t index) {
    const int row = static_cast<int>(index);
    const float* in = image.ptr<float>(row);
    float* radiance = out.radiance.ptr<float>(row);
    std::uint8_t* saturated = out.saturated.ptr<std::uint8_t>(row);
    for (int x = 0; x < image.cols; ++x) {
      bool clipped = false;
      for (int c = 0; c < channels; ++c) {
        const double dn = in[x * channels + c];
        const auto value = static_cast<float>(RadianceOfDn(dn, radiometry, transfer, factor) /
                                              WhiteBalance(radiometry, channels, c));
        const bool usable = std::isfinite(dn) && std::isfinite(value);
        radiance[x * channels + c] = usable ? value : 0.0f;
        clipped |= !usable || dn >= saturation;
      }
      saturated[x] = clipped ? 255 : 0;
    }
  });
}

void RemoveVignetting(const Vignetting& vignetting, LinearImage& image) {
  const int channels = image.radiance.channels();
  ParallelFor(static_cast<std::size_t>(image.radiance.rows), [&](std::size_t index) {
    const int row = static_cast<int>(index);
    float* radiance = image.radiance.ptr<float>(row);
    for (int x = 0; x < image.radiance.cols; ++x) {
      const double share = vignetting.ShareAt(x, row);
      if (share == 0.0) image.saturated(row, x) = 255;
      for (int c = 0; share != 0.0 && c < channels; ++c)
        radiance[x * channels + c] = static_cast<float>(radiance[x * channels + c] / share);
      if (share != 0.0 && !image.variance.empty())
        image.variance(row, x) = static_cast<float>(image.variance(row, x) / (share * share));
    }
  });
}

constexpr double kRoundingVariance = 1.0 / 12.0;  // of whole DN
constexpr int kReach = 2;                         // of a neighbourhood: 5 x 5

// The variance of linear DN at a DN.
double VarianceAt(double dn, const Radiometry& radiometry, const Transfer& transfer, double gain,
                  bool rounded) {
  const double range = radiometry.white - radiometry.black;
  const auto linear = [&](double at) { return RadianceOfDn(at, radiometry, transfer, range); };
  const double slope = rounded ? linear(dn + 0.5) - linear(dn - 0.5) : 0.0;
  const NoiseModel& noise = *radiometry.noise;
  return gain * gain * noise.read_noise_dn * noise.read_noise_dn +
         gain * noise.dn_per_electron * std::max(linear(dn), 0.0) +
         kRoundingVariance * slope * slope;
}

// The mean of a channel over the pixels around one, without its own. Between these bounds: what is
// broken must not spread. values: CV_32F.
double MeanAround(const cv::Mat& values, int row, int x, int channel, double low, double high) {
  double sum = 0.0;
  int count = 0;
  for (int r = std::max(row - kReach, 0); r <= std::min(row + kReach, values.rows - 1); ++r)
    for (int c = std::max(x - kReach, 0); c <= std::min(x + kReach, values.cols - 1); ++c) {
      const double value = values.ptr<float>(r)[c * values.channels() + channel];
      if ((r == row && c == x) || std::isnan(value)) continue;
      sum += std::clamp(value, low, high);
      ++count;
    }
  return count > 0 ? sum / count : low;
}

cv::Mat1f Variances(const cv::Mat& image, const Radiometry& radiometry, const Exposure& exposure,
                    double factor) {
  const bool rounded = image.depth() != CV_32F;
  cv::Mat values;
  image.convertTo(values, CV_32F);
  const double low = std::max(2.0 * radiometry.black - radiometry.white, rounded ? 0.0 : -HUGE_VAL),
               high = std::max(radiometry.white, radiometry.SaturationDn());
  const int channels = image.channels();
  const double gain = std::pow(
      10.0, (exposure.gain_db - radiometry.noise->gain_db.value_or(exposure.gain_db)) / 20.0);
  const Transfer transfer(radiometry);
  const auto variance_at = [&](double dn) {
    return VarianceAt(dn, radiometry, transfer, gain, rounded);
  };
  std::vector<double> table;  // whole DN are few
  if (rounded) {
    const std::size_t count = image.depth() == CV_8U ? 256 : 65536;
    for (std::size_t dn = 0; dn < count; ++dn)
      table.push_back(variance_at(static_cast<double>(dn)));
  }
  std::array<double, 3> scale{};  // DN to radiance
  for (int c = 0; c < channels; ++c)
    scale[static_cast<std::size_t>(c)] =
        factor / ((radiometry.white - radiometry.black) * WhiteBalance(radiometry, channels, c));
  cv::Mat1f out(image.size());
  ParallelFor(static_cast<std::size_t>(image.rows), [&](std::size_t index) {
    const int row = static_cast<int>(index);
    for (int x = 0; x < image.cols; ++x) {
      double sum = 0.0;
      for (int c = 0; c < channels; ++c) {
        const double s = scale[static_cast<std::size_t>(c)];
        const double dn = MeanAround(values, row, x, c, low, high);
        sum += s * s *
               (rounded ? table[static_cast<std::size_t>(
                              std::min(std::lround(dn), static_cast<long>(table.size() - 1)))]
                        : variance_at(dn));
      }
      out(row, x) = static_cast<float>(sum / channels);
    }
  });
  return out;
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
  const Transfer transfer(radiometry);
  ParallelFor(static_cast<std::size_t>(radiance.rows), [&](std::size_t index) {
    const int row = static_cast<int>(index);
    const float* in = radiance.ptr<float>(row);
    T* dn = out.ptr<T>(row);
    for (int i = 0; i < radiance.cols * channels; ++i) {
      const double balance = WhiteBalance(radiometry, channels, i % channels);
      const int column = i / channels;
      const double share =
          radiometry.vignetting ? radiometry.vignetting->ShareAt(column, row) : 1.0;
      const double s = transfer.Encode(in[i] * balance * share / factor);
      dn[i] = ToDn<T>(radiometry.black + s * (radiometry.white - radiometry.black));
    }
  });
}

}  // namespace

double Vignetting::Share(double q) const {
  double sum = 0.0;
  for (std::size_t i = coefficients.size(); i-- > 0;) sum = (sum + coefficients[i]) * q;
  return 1.0 + sum;
}

double Vignetting::ShareAt(double x, double y) const {
  const double dx = x - center_x, dy = y - center_y;
  const double q = (dx * dx + dy * dy) / (radius * radius);
  return q <= 1.0 ? Share(q) : 0.0;
}

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
  if (radiometry.noise) out.variance = Variances(image, radiometry, exposure, factor);
  if (radiometry.vignetting) RemoveVignetting(*radiometry.vignetting, out);
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
