#include "rig/session/picture_difference.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "base/statistics.h"

namespace turnlight::rig {
namespace {

constexpr int kBlockSide = 16;  // pixels; of each colour of a mosaic
// A block counts if this share of its values does.
constexpr double kFilledBlock = 0.5;
// A block tells of a shift from this mean square of its gradients on, in units of the difference's
// variance: noise alone gives 0.09.
constexpr double kStructure = 1.0;
// As many groups of equal size as there are values of each other level, but none so small that its
// noise is uncertain by more than about 2 %.
constexpr std::size_t kNoiseGroups = 32;
constexpr std::size_t kMinGroup = 5000;
// The level that says how noisy a value is, is the mean over such a square around it: of the value
// alone it would go with the very noise that is asked for, where zero cuts it off.
constexpr int kLevelSquare = 3;
// The variance of a group is the median of those of runs of so many of its values, neighbours along
// rows: a mean of squares does not ask how noise is distributed (whole DN, cut off at zero), and
// the median leaves edges out.
constexpr int kRun = 64;
constexpr double kVarianceOfRounding = 1.0 / 12.0;
constexpr double kLeastNoise = 1e-9;  // level; floats may have none at all

// Both pictures as levels: rows of `channels` values each.
struct Pair {
  cv::Mat a, b;  // CV_32F with the channels
  cv::Mat1b valid;
  int channels = 1;
};

// A mosaic's four colours as channels, half as wide and high; an odd last row or column is left
// out.
cv::Mat ColoursOfMosaic(const cv::Mat& mosaic) {
  std::vector<cv::Mat> colours;
  const cv::Size half(mosaic.cols / 2, mosaic.rows / 2);
  for (const cv::Point offset : {cv::Point(0, 0), {1, 0}, {0, 1}, {1, 1}}) {
    cv::Mat colour(half, mosaic.type());
    for (int y = 0; y < half.height; ++y)
      for (int x = 0; x < half.width; ++x)
        mosaic(cv::Rect(2 * x + offset.x, 2 * y + offset.y, 1, 1))
            .copyTo(colour(cv::Rect(x, y, 1, 1)));
    colours.push_back(colour);
  }
  cv::Mat merged;
  cv::merge(colours, merged);
  return merged;
}

cv::Mat LevelsOf(const cv::Mat& image, const calib::Radiometry& radiometry, bool mosaic) {
  const double scale = 1.0 / (radiometry.white - radiometry.black);
  cv::Mat levels;
  image.convertTo(levels, CV_32F, scale, -radiometry.black * scale);
  return mosaic ? ColoursOfMosaic(levels) : levels;
}

// The values that count, 255 of each channel: valid and finite in both, and not saturated in both.
// What is above saturation is made it, and what is not finite 0, as its neighbours' gradients see
// it.
cv::Mat1b CountingValues(Pair& pair, const calib::Radiometry& radiometry) {
  const auto saturation = static_cast<float>((radiometry.SaturationDn() - radiometry.black) /
                                             (radiometry.white - radiometry.black));
  cv::Mat1b counts(pair.a.rows, pair.a.cols * pair.channels, uchar{0});
  for (int y = 0; y < counts.rows; ++y) {
    auto* a = pair.a.ptr<float>(y);
    auto* b = pair.b.ptr<float>(y);
    for (int i = 0; i < counts.cols; ++i) {
      const bool finite = std::isfinite(a[i]) && std::isfinite(b[i]);
      a[i] = finite ? std::min(a[i], saturation) : 0.0F;
      b[i] = finite ? std::min(b[i], saturation) : 0.0F;
      if (finite && pair.valid(y, i / pair.channels) != 0 && std::min(a[i], b[i]) < saturation)
        counts(y, i) = 255;
    }
  }
  return counts;
}

// Collects squares of second differences; sigma of the noise that is behind them.
class BendNoise {
 public:
  void Add(float bend) {
    sum_ += static_cast<double>(bend) * static_cast<double>(bend);
    if (++count_ < kRun) return;
    means_.push_back(sum_ / count_);
    sum_ = 0.0;
    count_ = 0;
  }
  double Sigma() {
    if (means_.empty() && count_ > 0) means_.push_back(sum_ / count_);
    return std::sqrt(Median(means_) / 6.0);
  }

 private:
  std::vector<double> means_;
  double sum_ = 0.0;
  int count_ = 0;
};

// The levels at which one group ends and the next begins.
std::vector<float> GroupBounds(const cv::Mat1f& level, const cv::Mat1b& counts) {
  std::vector<float> levels;
  for (int y = 0; y < level.rows; ++y)
    for (int i = 0; i < level.cols; ++i)
      if (counts(y, i) != 0) levels.push_back(level(y, i));
  std::sort(levels.begin(), levels.end());
  const std::size_t groups = std::clamp<std::size_t>(levels.size() / kMinGroup, 1, kNoiseGroups);
  std::vector<float> bounds;
  for (std::size_t i = 1; i < groups; ++i) bounds.push_back(levels[i * levels.size() / groups]);
  return bounds;
}

std::size_t GroupOf(const std::vector<float>& bounds, float level) {
  return static_cast<std::size_t>(std::upper_bound(bounds.begin(), bounds.end(), level) -
                                  bounds.begin());
}

// The standard deviation of the difference a - b of each value.
cv::Mat1f NoiseOf(const Pair& pair, const cv::Mat1b& counts, double least) {
  cv::Mat smooth;
  cv::blur(0.5 * (pair.a + pair.b), smooth, {kLevelSquare, kLevelSquare});
  const cv::Mat1f level = smooth.reshape(1);
  const std::vector<float> bounds = GroupBounds(level, counts);
  std::vector<BendNoise> of_a(bounds.size() + 1), of_b(bounds.size() + 1);
  std::vector<BendNoise> of_difference(bounds.size() + 1);
  const int step = pair.channels;
  for (int y = 0; y < level.rows; ++y) {
    const auto* a = pair.a.ptr<float>(y);
    const auto* b = pair.b.ptr<float>(y);
    for (int i = step; i < level.cols - step; ++i) {
      if (counts(y, i - step) == 0 || counts(y, i) == 0 || counts(y, i + step) == 0) continue;
      const std::size_t group = GroupOf(bounds, level(y, i));
      const float bend_a = a[i - step] - 2.0F * a[i] + a[i + step];
      const float bend_b = b[i - step] - 2.0F * b[i] + b[i + step];
      of_a[group].Add(bend_a);
      of_b[group].Add(bend_b);
      of_difference[group].Add(bend_a - bend_b);
    }
  }
  std::vector<float> sigmas;
  for (std::size_t i = 0; i <= bounds.size(); ++i)
    sigmas.push_back(static_cast<float>(std::max(
        least, std::min(std::hypot(of_a[i].Sigma(), of_b[i].Sigma()), of_difference[i].Sigma()))));
  cv::Mat1f noise(level.size());
  for (int y = 0; y < level.rows; ++y)
    for (int i = 0; i < level.cols; ++i) noise(y, i) = sigmas[GroupOf(bounds, level(y, i))];
  return noise;
}

// How many sigmas a sum of squares of so many unit normals is above what chance gives: its cube
// root is nearly normal (Wilson and Hilferty 1931).
double SigmasOfSquares(double sum, double count) {
  const double variance = 2.0 / (9.0 * count);
  return (std::cbrt(sum / count) - (1.0 - variance)) / std::sqrt(variance);
}

// What least squares of b - a = level + shift . gradient find in one block.
struct BlockFit {
  int values = 0;
  double sum = 0.0;        // of b - a
  double structure = 0.0;  // mean square of the gradients in units of noise
  double of_level = 0.0;   // what the level alone explains: a square of a unit normal by chance
  double of_shift = 0.0;   // what the shift explains besides: two of them
  double shift_px = 0.0;
};

class BlockComparison {
 public:
  BlockComparison(const Pair& pair, const cv::Mat1b& counts, const cv::Mat1f& noise)
      : pair_(pair), counts_(counts), noise_(noise) {
    // Gradients of the mean, whose noise is independent of the difference's.
    const cv::Mat mean = 0.5 * (pair.a + pair.b);
    constexpr double kSobelSum = 8.0;
    cv::Sobel(mean, along_x_, CV_32F, 1, 0, 3, 1.0 / kSobelSum);
    cv::Sobel(mean, along_y_, CV_32F, 0, 1, 3, 1.0 / kSobelSum);
  }

  // noise_scale: what the noise has to be multiplied by for single values to fit it.
  void Compare(double noise_scale, int pixel_step, PictureDifference& result) const {
    const double unit = noise_scale * noise_scale;
    double level_squares = 0.0, shift_squares = 0.0, squares = 0.0, shifts = 0.0, pixels = 0.0;
    const cv::Rect all(0, 0, pair_.a.cols, pair_.a.rows);
    for (int top = 0; top < all.height; top += kBlockSide)
      for (int left = 0; left < all.width; left += kBlockSide) {
        const cv::Rect block = cv::Rect(left, top, kBlockSide, kBlockSide) & all;
        const BlockFit fit = Fit(block);
        if (fit.values == 0 || fit.values < kFilledBlock * block.area() * pair_.channels) continue;
        ++result.blocks;
        const double mean = fit.sum / fit.values;
        squares += mean * mean;
        level_squares += fit.of_level / unit;
        const bool has_shift = fit.structure > kStructure;
        if (has_shift) {
          shift_squares += fit.of_shift / unit;
          shifts += 2.0;
          pixels += fit.shift_px * fit.shift_px;
        }
        const double sigmas = has_shift ? SigmasOfSquares((fit.of_level + fit.of_shift) / unit, 3.0)
                                        : SigmasOfSquares(fit.of_level / unit, 1.0);
        if (result.blocks > 1 && sigmas <= result.largest_sigmas) continue;
        result.largest_sigmas = sigmas;
        result.largest = std::abs(mean);
        result.largest_at = {pixel_step * (block.x + block.width / 2),
                             pixel_step * (block.y + block.height / 2)};
      }
    if (result.blocks == 0) return;
    const auto count = static_cast<double>(result.blocks);
    result.level_rms = std::sqrt(squares / count);
    result.level_sigmas = SigmasOfSquares(level_squares, count);
    if (shifts == 0.0) return;
    result.shift_sigmas = SigmasOfSquares(shift_squares, shifts);
    result.shift_rms_px = pixel_step * std::sqrt(pixels / (0.5 * shifts));
  }

 private:
  BlockFit Fit(const cv::Rect& block) const {
    BlockFit fit;
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (int y = block.y; y < block.y + block.height; ++y)
      for (int i = block.x * pair_.channels; i < (block.x + block.width) * pair_.channels; ++i) {
        if (counts_(y, i) == 0) continue;
        const auto sigma = static_cast<double>(noise_(y, i));
        const double difference = static_cast<double>(pair_.b.ptr<float>(y)[i]) -
                                  static_cast<double>(pair_.a.ptr<float>(y)[i]);
        const Eigen::Vector3d row(1.0, static_cast<double>(along_x_.ptr<float>(y)[i]),
                                  static_cast<double>(along_y_.ptr<float>(y)[i]));
        const Eigen::Vector3d scaled = row / sigma;
        normal += scaled * scaled.transpose();
        right += scaled * (difference / sigma);
        fit.sum += difference;
        ++fit.values;
      }
    if (fit.values == 0) return fit;
    fit.structure = (normal(1, 1) + normal(2, 2)) / fit.values;
    fit.of_level = right[0] * right[0] / normal(0, 0);
    // Gradients may all point one way: the least ridge keeps the solution finite.
    constexpr double kRidge = 1e-9;
    normal.diagonal().tail<2>().array() += kRidge * (normal(1, 1) + normal(2, 2) + 1.0);
    const Eigen::Vector3d solution = normal.ldlt().solve(right);
    fit.of_shift = std::max(0.0, right.dot(solution) - fit.of_level);
    fit.shift_px = solution.tail<2>().norm();
    return fit;
  }

  const Pair& pair_;
  const cv::Mat1b& counts_;
  const cv::Mat1f& noise_;
  cv::Mat along_x_, along_y_;
};

// rms, rms_in_noise and brightness.
void CompareValues(const Pair& pair, const cv::Mat1b& counts, const cv::Mat1f& noise,
                   PictureDifference& result) {
  double squares = 0.0, in_noise = 0.0, weighted = 0.0, weight = 0.0;
  for (int y = 0; y < counts.rows; ++y)
    for (int i = 0; i < counts.cols; ++i) {
      if (counts(y, i) == 0) continue;
      const auto a = static_cast<double>(pair.a.ptr<float>(y)[i]);
      const auto b = static_cast<double>(pair.b.ptr<float>(y)[i]);
      const double variance = static_cast<double>(noise(y, i)) * static_cast<double>(noise(y, i));
      const double difference = b - a;
      const double mean = 0.5 * (a + b);
      squares += difference * difference;
      in_noise += difference * difference / variance;
      weighted += mean * difference / variance;
      weight += mean * mean / variance;
      ++result.values;
    }
  if (result.values == 0) return;
  const auto count = static_cast<double>(result.values);
  result.rms = std::sqrt(squares / count);
  result.rms_in_noise = std::sqrt(in_noise / count);
  if (!(weight > 0.0)) return;
  result.brightness = weighted / weight;
  result.brightness_sigma = 1.0 / std::sqrt(weight);
}

}  // namespace

PictureDifference ComparePictures(const cv::Mat& a, const cv::Mat& b, const cv::Mat1b& valid,
                                  const calib::Radiometry& radiometry, bool mosaic) {
  Pair pair{LevelsOf(a, radiometry, mosaic), LevelsOf(b, radiometry, mosaic), valid, 1};
  if (mosaic) {
    const cv::Mat of_colours = ColoursOfMosaic(valid);
    std::vector<cv::Mat1b> each;
    cv::split(of_colours, each);
    pair.valid = each[0] & each[1] & each[2] & each[3];
  }
  pair.channels = pair.a.channels();
  const cv::Mat1b counts = CountingValues(pair, radiometry);
  const double of_rounding = std::sqrt(2.0 * kVarianceOfRounding);
  const double dn = 1.0 / (radiometry.white - radiometry.black);
  const double least = a.depth() == CV_32F ? kLeastNoise : of_rounding * dn;
  const cv::Mat1f noise = NoiseOf(pair, counts, least);
  PictureDifference result;
  CompareValues(pair, counts, noise, result);
  if (result.rms_in_noise > 0.0)
    BlockComparison(pair, counts, noise).Compare(result.rms_in_noise, mosaic ? 2 : 1, result);
  return result;
}

}  // namespace turnlight::rig
