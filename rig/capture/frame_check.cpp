#include "rig/capture/frame_check.h"

#include <algorithm>
#include <cmath>

#include "base/format.h"
#include "base/statistics.h"

namespace turnlight::rig {
namespace {

constexpr double kBrightShare = 0.01;  // of pixels
constexpr double kLitLevel = 0.01;     // of white
constexpr double kVarianceOfRounding = 1.0 / 12.0;
constexpr int kBlock = 8;  // pixels

// Of a good exposure: what may be clipped (glints), and where the brightest of the rest are.
constexpr double kGoodClippedShare = 0.001;
constexpr double kGoodBrightest = 0.8;  // of saturation
// A clipped picture is at least this much too bright: less is not worth a change.
constexpr double kLeastReduction = 0.5;
constexpr double kMostReduction = 1.0 / 16.0;
constexpr double kBlindReduction = 1.0 / 8.0;  // when too few pixels are left to judge by
constexpr double kLeastUnclipped = 0.02;
constexpr double kMostIncrease = 100.0;
constexpr double kWorthIncreasing = 1.6;

// Levels of all channels, as float; NaN stays.
cv::Mat1f ToLevels(const cv::Mat& image, const calib::Radiometry& radiometry) {
  const double scale = 1.0 / (radiometry.white - radiometry.black);
  cv::Mat levels;
  image.reshape(1).convertTo(levels, CV_32F, scale, -radiometry.black * scale);
  return levels;
}

// A level of exactly that much may have been rounded down, by less than any step between DN.
constexpr float kLevelRounding = 5e-7f;

float SaturationLevel(const calib::Radiometry& radiometry) {
  return static_cast<float>((radiometry.SaturationDn() - radiometry.black) /
                            (radiometry.white - radiometry.black)) -
         kLevelRounding;
}

std::string Percent(double share) { return Format("%.3g %%", 100.0 * share); }

std::string Ratio(double ratio) { return NumberText(ratio, 3); }

// The level that this share of the pixels exceeds.
double ExceededBy(double share, std::vector<float>& brightest) {
  return static_cast<double>(LowerQuantile(brightest, 1.0 - share));
}

// brightest: each pixel's level, of its brightest channel.
double ExposureFactor(double clipped, double saturation, std::vector<float>& brightest) {
  const double wanted = kGoodBrightest * saturation;
  if (clipped <= kGoodClippedShare) {
    const double level = ExceededBy(kGoodClippedShare, brightest);
    return level * kMostIncrease > wanted ? wanted / level : kMostIncrease;
  }
  const double below = 1.0 - clipped;
  if (below < kLeastUnclipped) return kBlindReduction;
  // The bright end goes on as it begins: levels grow with the logarithm of the share above them.
  const double share = clipped + std::min(clipped, 0.25 * below);
  const double more = clipped + std::min(3.0 * clipped, 0.5 * below);
  const double level = ExceededBy(share, brightest);
  const double slope = (level - ExceededBy(more, brightest)) / std::log(more / share);
  const double brightest_level = level + slope * std::log(share / kGoodClippedShare);
  return std::clamp(wanted / std::max(brightest_level, 1e-6), kMostReduction, kLeastReduction);
}

// To two digits or to the unit, and never as a power of ten.
std::string Shortly(double value) {
  if (value < 0.005) return "0";
  return value < 10.0 ? NumberText(value, 2) : NumberText(std::round(value));
}

// "halve the exposure", "multiply the exposure by 20".
std::string ExposureWords(double factor) {
  const double times = factor < 1.0 ? 1.0 / factor : factor;
  const bool twice = times > 1.75 && times < 2.3;
  if (factor < 1.0)
    return twice ? "halve the exposure" : "divide the exposure by " + Shortly(times);
  return twice ? "double the exposure"
               : "multiply the exposure by " + Shortly(times) +
                     (factor >= kMostIncrease ? " or more" : "");
}

// Fills in the blocks' part. counts(row, i): whether a value takes part.
template <typename Counts>
void CompareBlocks(const cv::Mat1f& a, const cv::Mat1f& b, int channels, const Counts& counts,
                   FrameDifference& result) {
  double sum_sigmas = 0.0, sum_squares = 0.0, sum_levels = 0.0;
  const int width = kBlock * channels;
  for (int top = 0; top < a.rows; top += kBlock)
    for (int left = 0; left < a.cols; left += width) {
      double difference = 0.0, level = 0.0;
      int values = 0;
      for (int row = top; row < std::min(top + kBlock, a.rows); ++row)
        for (int i = left; i < std::min(left + width, a.cols); ++i) {
          if (!counts(row, i)) continue;
          difference += static_cast<double>(a(row, i)) - static_cast<double>(b(row, i));
          level += 0.5 * (static_cast<double>(a(row, i)) + static_cast<double>(b(row, i)));
          ++values;
        }
      if (2 * values < kBlock * width) continue;
      ++result.blocks;
      sum_sigmas += difference * difference / values / (result.noise_rms * result.noise_rms);
      sum_squares += difference * difference / values / values;
      sum_levels += level * level / values / values;
    }
  if (result.blocks == 0) return;
  result.block_sigmas = std::sqrt(sum_sigmas / result.blocks);
  result.block_share = std::sqrt(sum_squares / sum_levels);
}

}  // namespace

FrameStatistics MeasureFrame(const cv::Mat& image, const calib::Radiometry& radiometry) {
  const int channels = image.channels();
  const cv::Mat1f levels = ToLevels(image, radiometry);
  const float saturation = SaturationLevel(radiometry);
  std::vector<float> brightest;
  brightest.reserve(image.total());
  double sum = 0.0;
  std::size_t saturated = 0;
  for (int row = 0; row < levels.rows; ++row) {
    const float* in = levels[row];
    for (int x = 0; x < image.cols; ++x) {
      float most = -1e30f;
      bool clipped = false;
      for (int c = 0; c < channels; ++c) {
        const float level = in[x * channels + c];
        const bool over = !(level < saturation) || !std::isfinite(level);
        clipped |= over;
        sum += over ? saturation : level;
        most = std::max(most, over ? saturation : level);
      }
      saturated += clipped ? 1 : 0;
      brightest.push_back(most);
    }
  }
  const auto count = static_cast<double>(brightest.size());
  const auto rank = static_cast<std::size_t>((1.0 - kBrightShare) * count);
  const double clipped = static_cast<double>(saturated) / count;
  return {sum / (count * channels), OrderStatistic(brightest, rank), clipped,
          ExposureFactor(clipped, static_cast<double>(saturation), brightest)};
}

std::string ExposureAdvice(const FrameStatistics& statistics) {
  if (statistics.saturated_share > kGoodClippedShare)
    return Shortly(100.0 * statistics.saturated_share) +
           " % clipped: " + ExposureWords(statistics.exposure_factor);
  if (statistics.exposure_factor < kWorthIncreasing) return "";
  return "mean level " + Shortly(100.0 * statistics.mean_level) +
         " % of white: " + ExposureWords(statistics.exposure_factor);
}

FrameCheck CheckFrame(const cv::Mat& image, const calib::Radiometry& radiometry,
                      const FrameGate& gate, const std::vector<double>& previous) {
  FrameCheck check;
  check.statistics = MeasureFrame(image, radiometry);
  const auto refuse = [&check](FrameVerdict verdict, std::string text) {
    check.verdict = verdict;
    check.text = std::move(text);
    return check;
  };
  const FrameStatistics& found = check.statistics;
  if (found.bright_level < gate.min_bright_level)
    return refuse(FrameVerdict::kAllBlack,
                  "all black: the brightest 1 % of the pixels begin at " +
                      Percent(found.bright_level) + " of white, allowed is at least " +
                      Percent(gate.min_bright_level) +
                      "; check the lamp and the lens cap; if they are well, " +
                      ExposureWords(std::max(found.exposure_factor, kWorthIncreasing)));
  if (found.saturated_share > gate.max_saturated_share)
    return refuse(FrameVerdict::kSaturated, "saturated: " + Percent(found.saturated_share) +
                                                " of the pixels, allowed are " +
                                                Percent(gate.max_saturated_share) + ": " +
                                                ExposureWords(found.exposure_factor));
  if (previous.empty() || previous.size() < gate.min_history) return check;
  std::vector<double> levels = previous;
  const double usual = Median(levels);
  if (!(usual > 0.0)) return check;
  const double ratio = found.mean_level / usual;
  const std::string measured = "the mean level is " + Ratio(ratio) + " of the median of the " +
                               std::to_string(previous.size()) + " frames before, allowed is ";
  if (ratio < gate.min_level_ratio)
    return refuse(FrameVerdict::kLampOff,
                  "lamp off? " + measured + Ratio(gate.min_level_ratio) + " or more");
  if (ratio > gate.max_level_ratio)
    return refuse(FrameVerdict::kLampBright,
                  "light changed? " + measured + Ratio(gate.max_level_ratio) + " or less");
  return check;
}

FrameDifference CompareFrames(const cv::Mat& first, const cv::Mat& second,
                              const calib::Radiometry& radiometry) {
  const cv::Mat1f a = ToLevels(first, radiometry);
  const cv::Mat1f b = ToLevels(second, radiometry);
  const float saturation = SaturationLevel(radiometry);
  const int channels = first.channels();
  const auto counts = [&](int row, int i) {
    return a(row, i) < saturation && b(row, i) < saturation &&
           std::max(a(row, i), b(row, i)) > kLitLevel;
  };
  const auto difference = [&](int row, int i) {
    return static_cast<double>(a(row, i)) - static_cast<double>(b(row, i));
  };
  FrameDifference result;
  double squares = 0.0;
  std::vector<double> bends;  // second differences, in which what changes slowly cancels
  for (int row = 0; row < a.rows; ++row)
    for (int i = 0; i < a.cols; ++i) {
      if (!counts(row, i)) continue;
      ++result.pixels;
      squares += difference(row, i) * difference(row, i);
      const int before = i - channels;
      const int after = i + channels;
      if (before >= 0 && after < a.cols && counts(row, before) && counts(row, after))
        bends.push_back(
            std::abs(difference(row, before) - 2.0 * difference(row, i) + difference(row, after)));
    }
  if (result.pixels == 0) return result;
  result.rms = std::sqrt(squares / static_cast<double>(result.pixels));
  const double scale = 1.0 / (radiometry.white - radiometry.black);
  const double rounding =
      first.depth() == CV_32F ? 0.0 : std::sqrt(2.0 * kVarianceOfRounding) * scale;
  const double measured = SigmaOfSecondDifference(Median(bends), kMedianOfNormal);
  result.noise_rms = std::max({measured, rounding, 1e-9});
  CompareBlocks(a, b, channels, counts, result);
  return result;
}

}  // namespace turnlight::rig
