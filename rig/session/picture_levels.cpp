#include "rig/session/picture_levels.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/format.h"

namespace turnlight::rig {
namespace {

constexpr std::size_t kValues = 65536;
constexpr std::size_t kLeastDistinct = 32;  // below, a picture is drawn rather than taken
constexpr double kLeastShare = 1e-4;        // of the target's pixels, to be a plateau
// A smooth peak has no more of its largest value than 2.4 times those of the next; clipping
// collects all that lies above.
constexpr std::uint32_t kAboveNext = 8;
constexpr int kNext = 8;
constexpr double kRamp = 0.05;  // values within this share below a plateau lead up to it ...
constexpr double kLeastRamp =
    0.02;                          // ... and are at least this share of it: else it is a flat area
constexpr double kFarBelow = 8.0;  // white is doubtful where all values are smaller by this factor

using Histogram = std::vector<std::uint32_t>;

// Whole numbers of 0 to 65535?
bool IsWhole(const cv::Mat& image) {
  if (image.depth() != CV_32F) return true;
  const cv::Mat flat = image.reshape(1);
  for (int y = 0; y < flat.rows; ++y) {
    const float* row = flat.ptr<float>(y);
    for (int x = 0; x < flat.cols; ++x)
      if (!(row[x] >= 0.0f && row[x] < static_cast<float>(kValues) && row[x] == std::floor(row[x])))
        return false;
  }
  return true;
}

template <typename T>
void Count(const cv::Mat& image, const cv::Mat1b& mask, PictureLevels& levels,
           std::vector<Histogram>& histograms) {
  const int channels = image.channels();
  std::uint32_t used = 0, largest = 0;
  for (int y = 0; y < image.rows; ++y) {
    const T* value = image.ptr<T>(y);
    const std::uint8_t* on_target = mask.ptr<std::uint8_t>(y);
    for (int x = 0; x < image.cols; ++x)
      for (int c = 0; c < channels; ++c, ++value) {
        const auto dn = static_cast<std::uint32_t>(*value);
        used |= dn;
        largest = std::max(largest, dn);
        if (on_target[x]) ++histograms[static_cast<std::size_t>(c)][dn];
      }
  }
  levels.used_bits = used;
  levels.largest = largest;
}

// Whether the values below `top` lead up to it, and none of the next is nearly as frequent.
bool IsClippedAt(const Histogram& histogram, std::size_t top) {
  const auto first = static_cast<std::size_t>(static_cast<double>(top) * (1.0 - kRamp));
  std::uint64_t ramp = 0;
  std::uint32_t most = 0;
  int seen = 0;
  for (std::size_t dn = top; dn-- > first;) {
    ramp += histogram[dn];
    if (histogram[dn] > 0 && seen++ < kNext) most = std::max(most, histogram[dn]);
  }
  const double count = histogram[top];
  return seen > 0 && count >= double{kAboveNext} * most &&
         static_cast<double>(ramp) >= kLeastRamp * count;
}

ChannelLevels ChannelOf(const Histogram& histogram) {
  ChannelLevels levels;
  std::uint64_t pixels = 0, above = 0;
  for (const std::uint32_t count : histogram) pixels += count;
  const auto often = static_cast<std::uint64_t>(
      std::max(double{kLeastOften}, kLeastShare * static_cast<double>(pixels)));
  for (std::size_t dn = kValues; dn-- > 0; above += histogram[dn]) {
    if (above + histogram[dn] < often) continue;
    levels.largest_often = static_cast<double>(dn);
    // What is above are hot pixels.
    if (histogram[dn] >= often && IsClippedAt(histogram, dn))
      levels.plateau = static_cast<double>(dn);
    break;
  }
  return levels;
}

// The session's levels, from those of its frames.
struct Levels {
  std::uint32_t used_bits = 0;
  double largest = 0.0;
  std::size_t distinct = 0;  // at most in a frame
  std::optional<double> plateau;
  std::size_t plateau_frames = 0;
};

// The plateau that frames share in a channel, beyond which none has pixels.
void FindPlateau(const std::vector<PictureLevels>& frames, std::size_t channel, Levels& levels) {
  double value = 0.0, largest = 0.0;
  std::size_t count = 0;
  for (const PictureLevels& frame : frames) {
    if (channel >= frame.channels.size()) continue;
    const ChannelLevels& in = frame.channels[channel];
    largest = std::max(largest, in.largest_often);
    if (!in.plateau || *in.plateau < value) continue;
    count = *in.plateau > value ? 1 : count + 1;
    value = *in.plateau;
  }
  if (count < std::min<std::size_t>(frames.size(), 2) || largest > value) return;
  if (levels.plateau && *levels.plateau <= value) return;
  levels.plateau = value;
  levels.plateau_frames = count;
}

std::string Whole(double value) { return NumberText(value, 9); }

std::string SaturationWords(const calib::Radiometry& radiometry) {
  return radiometry.saturation
             ? "radiometry/saturation is " + Whole(*radiometry.saturation)
             : "radiometry/saturation is not given and taken as white, " + Whole(radiometry.white);
}

// 2^n - 1 that holds the value.
double FullScale(double value) { return std::exp2(std::ceil(std::log2(value + 1.0))) - 1.0; }

// What sets `white`, and saturation where it is set besides.
std::string SetWhite(const calib::Radiometry& radiometry, double white) {
  return "set \"white\": " + Whole(white) +
         (radiometry.saturation ? ", and \"saturation\" to no more" : "");
}

std::string PlateauText(const calib::Radiometry& radiometry, const Levels& levels,
                        std::size_t frames) {
  const double value = *levels.plateau, full = FullScale(value);
  std::string text = std::to_string(levels.plateau_frames) + " of " + std::to_string(frames) +
                     " pictures are clipped at " + Whole(value) +
                     ", the largest value that occurs often; " + SaturationWords(radiometry) +
                     ", so that no pixel counts as clipped; ";
  const bool whole_scale = value == full && radiometry.white >= 2.0 * value;
  return text + (whole_scale ? SetWhite(radiometry, value) : "set \"saturation\": " + Whole(value));
}

}  // namespace

PictureLevels MeasureLevels(const cv::Mat& image, const cv::Mat1b& mask) {
  PictureLevels levels;
  levels.whole = IsWhole(image);
  if (!levels.whole) return levels;
  levels.bits = image.depth() == CV_8U ? 8 : 16;
  std::vector<Histogram> histograms(static_cast<std::size_t>(image.channels()),
                                    Histogram(kValues, 0));
  switch (image.depth()) {
    case CV_8U:
      Count<std::uint8_t>(image, mask, levels, histograms);
      break;
    case CV_16U:
      Count<std::uint16_t>(image, mask, levels, histograms);
      break;
    default:
      Count<float>(image, mask, levels, histograms);
      break;
  }
  for (const Histogram& histogram : histograms) {
    levels.channels.push_back(ChannelOf(histogram));
    const auto used = static_cast<std::size_t>(
        std::count_if(histogram.begin(), histogram.end(), [](std::uint32_t n) { return n > 0; }));
    levels.distinct = std::max(levels.distinct, used);
  }
  return levels;
}

std::string LevelsText(const calib::Radiometry& radiometry,
                       const std::vector<PictureLevels>& frames) {
  Levels levels;
  std::size_t channels = 0;
  int bits = 0;
  for (const PictureLevels& frame : frames) {
    if (!frame.whole) return "";
    bits = std::max(bits, frame.bits);
    levels.used_bits |= frame.used_bits;
    levels.largest = std::max(levels.largest, frame.largest);
    levels.distinct = std::max(levels.distinct, frame.distinct);
    channels = std::max(channels, frame.channels.size());
  }
  if (levels.distinct < kLeastDistinct) return "";
  for (std::size_t c = 0; c < channels; ++c) FindPlateau(frames, c, levels);
  if (levels.plateau && *levels.plateau < radiometry.SaturationDn())
    return PlateauText(radiometry, levels, frames.size());
  const int zero_bits = std::countr_zero(levels.used_bits);
  const double full = std::exp2(bits) - std::exp2(zero_bits);
  if (bits == 16 && zero_bits > 0 && radiometry.SaturationDn() > full)
    return "all values are multiples of " + std::to_string(1 << zero_bits) + ": " +
           std::to_string(bits - zero_bits) +
           " bits, left-aligned in 16, the largest of which is " + Whole(full) + "; " +
           SaturationWords(radiometry) +
           ", which no pixel reaches when it is clipped; set \"saturation\": " + Whole(full);
  if (bits == 16 && (levels.largest + 1.0) * kFarBelow <= radiometry.white + 1.0)
    return "no value exceeds " + Whole(levels.largest) + ", while radiometry/white is " +
           Whole(radiometry.white) + ": the pictures are dark, or of fewer bits than white; if " +
           "the camera gives " +
           std::to_string(std::bit_width(static_cast<std::uint32_t>(levels.largest))) + " bits, " +
           SetWhite(radiometry, FullScale(levels.largest));
  return "";
}

}  // namespace turnlight::rig
