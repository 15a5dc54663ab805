#include "estimator/observe/broken_pixels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "base/statistics.h"

namespace turnlight::estimator::observe {
namespace {

constexpr double kTimesTypical = 1e4;
constexpr double kManySpikes = 5e-4;  // of the target's pixels
constexpr double kManyAtFloor = 2e-3;
constexpr float kSigmas = 6.0f, kSteps = 3.0f;
constexpr double kFloorSigmas = 2.0;  // from here on the mean is less than 0.01 sigma off
constexpr float kWellAbove = 4.0f;    // sigmas
constexpr int kReach = 2;             // 5 x 5
constexpr int kPasses = 2;

// One channel of a picture and which of its pixels count.
struct Channel {
  cv::Mat1f value;
  const cv::Mat1b& target;
  cv::Mat1b& broken;

  bool Good(int row, int column) const {
    return row >= 0 && column >= 0 && row < value.rows && column < value.cols &&
           target(row, column) != 0 && broken(row, column) == 0;
  }
};

void MarkImplausible(Channel& channel) {
  std::vector<float> positive;
  for (int row = 0; row < channel.value.rows; ++row)
    for (int column = 0; column < channel.value.cols; ++column) {
      const float v = channel.value(row, column);
      if (channel.target(row, column) != 0 && std::isfinite(v) && v > 0.0f) positive.push_back(v);
    }
  const double largest = positive.empty()
                             ? std::numeric_limits<double>::infinity()
                             : kTimesTypical * static_cast<double>(LowerQuantile(positive, 0.8));
  for (int row = 0; row < channel.value.rows; ++row)
    for (int column = 0; column < channel.value.cols; ++column) {
      const auto v = static_cast<double>(channel.value(row, column));
      if (channel.target(row, column) != 0 && !(std::isfinite(v) && std::abs(v) <= largest))
        channel.broken(row, column) |= kImplausible;
    }
}

// Sigma of the noise from second differences along rows, of pixels that `of` names (all if it is
// empty). Their 20 % quantile: of a picture with many outliers most differences hold one.
float Noise(const Channel& channel, const cv::Mat1b& of = {}) {
  std::vector<float> differences;
  for (int row = 0; row < channel.value.rows; ++row)
    for (int column = 1; column + 1 < channel.value.cols; ++column)
      if (channel.Good(row, column - 1) && channel.Good(row, column) &&
          channel.Good(row, column + 1) && (of.empty() || of(row, column) != 0))
        differences.push_back(std::abs(channel.value(row, column - 1) -
                                       2.0f * channel.value(row, column) +
                                       channel.value(row, column + 1)));
  // 0.2533: the 20 % quantile of a unit normal's magnitude.
  return SigmaOfSecondDifference(LowerQuantile(differences, 0.2), 0.2533f);
}

// The smallest difference but 0 that it was shown. In a picture of 8 bits it is the step from one
// number to the next, which noise smaller than that turns into lone pixels.
struct Step {
  float smallest = std::numeric_limits<float>::infinity();
  void Take(float difference) {
    if (difference != 0.0f) smallest = std::min(smallest, std::abs(difference));
  }
};

// Darker than all its eight neighbours by more than noise, by more than they differ, and by several
// steps of the sensor's numbers: the smallest difference there is around it.
bool DarkSpike(const Channel& channel, int row, int column, float noise) {
  float low = std::numeric_limits<float>::infinity(), high = -low;
  Step step;
  for (int r = row - 1; r <= row + 1; ++r)
    for (int c = column - 1; c <= column + 1; ++c) {
      if (r == row && c == column) continue;
      if (!channel.Good(r, c)) return false;
      low = std::min(low, channel.value(r, c));
      high = std::max(high, channel.value(r, c));
      step.Take(channel.value(r, c) - channel.value(row, column));
    }
  for (int r = row - 1; r <= row + 1; ++r)
    for (int c = column - 1; c <= column + 1; ++c)
      if (r != row || c != column) step.Take(channel.value(r, c) - low);
  return channel.value(row, column) <
         low - std::max({kSigmas * noise, 0.5f * (high - low), kSteps * step.smallest});
}

bool HasOutliers(const Channel& channel, float noise) {
  std::size_t spikes = 0, pixels = 0;
  for (int row = 0; row < channel.value.rows; ++row)
    for (int column = 0; column < channel.value.cols; ++column) {
      if (!channel.Good(row, column)) continue;
      ++pixels;
      spikes += DarkSpike(channel, row, column, noise) ? 1 : 0;
    }
  return spikes >= 3 && static_cast<double>(spikes) > kManySpikes * static_cast<double>(pixels);
}

void MarkOutliers(Channel& channel, float noise) {
  const cv::Mat1b before = channel.broken.clone();
  const Channel known{channel.value, channel.target, const_cast<cv::Mat1b&>(before)};
  std::vector<float> around;
  for (int row = 0; row < channel.value.rows; ++row)
    for (int column = 0; column < channel.value.cols; ++column) {
      if (!known.Good(row, column)) continue;
      around.clear();
      for (int r = row - kReach; r <= row + kReach; ++r)
        for (int c = column - kReach; c <= column + kReach; ++c)
          if ((r != row || c != column) && known.Good(r, c)) around.push_back(channel.value(r, c));
      const float median = LowerQuantile(around, 0.5);
      Step step;
      step.Take(channel.value(row, column) - median);
      for (float& v : around) {
        step.Take(v - median);
        v = std::abs(v - median);
      }
      const float spread = LowerQuantile(around, 0.5) / static_cast<float>(kMedianOfNormal);
      // Too few left around it: what they say about it is chance.
      const bool alone = around.size() < 6;
      const float limit = std::max(kSigmas * std::max(noise, spread), kSteps * step.smallest);
      if (alone || std::abs(channel.value(row, column) - median) > limit)
        channel.broken(row, column) |= kOutlier;
    }
}

void MarkFloored(Channel& channel, float noise) {
  float floor = std::numeric_limits<float>::infinity();
  std::size_t pixels = 0, at_floor = 0, scattered = 0;
  cv::Mat1f value = cv::Mat1f::zeros(channel.value.size());
  cv::Mat1f weight = cv::Mat1f::zeros(channel.value.size());
  for (int row = 0; row < value.rows; ++row)
    for (int column = 0; column < value.cols; ++column)
      if (channel.Good(row, column)) {
        value(row, column) = channel.value(row, column);
        weight(row, column) = 1.0f;
        floor = std::min(floor, channel.value(row, column));
        ++pixels;
      }
  // Noise scatters the lowest value; in a shadow without noise it fills an area.
  const auto at = [&](int row, int column) {
    return channel.Good(row, column) && channel.value(row, column) == floor;
  };
  for (int row = 0; row < value.rows; ++row)
    for (int column = 0; column < value.cols; ++column) {
      if (!at(row, column)) continue;
      ++at_floor;
      const bool surrounded =
          at(row - 1, column) && at(row + 1, column) && at(row, column - 1) && at(row, column + 1);
      scattered += surrounded ? 0 : 1;
    }
  const bool many = static_cast<double>(at_floor) >= kManyAtFloor * static_cast<double>(pixels);
  if (!(noise > 0.0f) || !many || 2 * scattered < at_floor) return;
  const cv::Size window(2 * kReach + 1, 2 * kReach + 1);
  cv::boxFilter(value, value, -1, window);
  cv::boxFilter(weight, weight, -1, window);
  // What is cut off looks less noisy than it is: the noise is that of what is well above.
  cv::Mat1b above(value.size(), std::uint8_t{1});
  for (int pass = 0; pass < kPasses; ++pass) {
    for (int row = 0; row < value.rows; ++row)
      for (int column = 0; column < value.cols; ++column)
        above(row, column) =
            value(row, column) > (floor + kWellAbove * noise) * weight(row, column) ? 1 : 0;
    noise = std::max(noise, Noise(channel, above));
  }
  const float limit = floor + static_cast<float>(kFloorSigmas) * noise;
  cv::Mat1b below(value.size(), std::uint8_t{0});
  for (int row = 0; row < value.rows; ++row)
    for (int column = 0; column < value.cols; ++column)
      below(row, column) =
          channel.Good(row, column) && value(row, column) < limit * weight(row, column) ? kFloored
                                                                                        : 0;
  // And all around: what is not below there got over the limit by its noise.
  cv::dilate(below, below, cv::Mat1b(window, std::uint8_t{1}));
  channel.broken |= below;
}

}  // namespace

cv::Mat1b FindBrokenPixels(const cv::Mat& radiance, const cv::Mat1b& target) {
  cv::Mat1b out(radiance.size(), std::uint8_t{0});
  for (int c = 0; c < radiance.channels(); ++c) {
    cv::Mat1b broken(radiance.size(), std::uint8_t{0});
    cv::Mat1f value;
    cv::extractChannel(radiance, value, c);
    Channel channel{value, target, broken};
    MarkImplausible(channel);
    const float noise = Noise(channel);
    if (HasOutliers(channel, noise))
      for (int pass = 0; pass < kPasses; ++pass) MarkOutliers(channel, noise);
    MarkFloored(channel, Noise(channel));
    out |= broken;
  }
  return out;
}

}  // namespace turnlight::estimator::observe
