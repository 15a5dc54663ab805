#include "estimator/observe/radiance_statistics.h"

#include <cmath>
#include <vector>

#include "base/statistics.h"

namespace turnlight::estimator::observe {
namespace {

std::vector<float> Values(const Observations& all, int channel) {
  std::vector<float> values;
  values.reserve(all.used);
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all.pixel[i] != Observations::kNoPixel) values.push_back(all.radiance[channel][i]);
  return values;
}

}  // namespace

double EstimateNoise(const Observations& all) {
  std::vector<float> differences;
  for (std::size_t i = 1; i + 1 < all.size(); ++i) {
    if (all.pixel[i] == Observations::kNoPixel || all.pixel[i - 1] + 1 != all.pixel[i] ||
        all.pixel[i] + 1 != all.pixel[i + 1] || all.IsAtWhite(i - 1) || all.IsAtWhite(i) ||
        all.IsAtWhite(i + 1))
      continue;
    const float weight = all.weight.empty() ? 1.0f : all.weight[i];
    for (int c = 0; c < all.channels; ++c)
      differences.push_back(weight * std::abs(all.radiance[c][i - 1] - 2.0f * all.radiance[c][i] +
                                              all.radiance[c][i + 1]));
  }
  return SigmaOfSecondDifference(static_cast<double>(Median(differences)), kMedianOfNormal);
}

Eigen::Vector3d MedianColour(const Observations& observations) {
  Eigen::Vector3d colour = Eigen::Vector3d::Zero();
  for (int c = 0; c < observations.channels; ++c) {
    std::vector<float> values = Values(observations, c);
    colour[c] = static_cast<double>(Median(values));
  }
  if (observations.channels == 1) colour.setConstant(colour[0]);
  return colour;
}

double DarkRadiance(const Observations& observations, int channel) {
  std::vector<float> values = Values(observations, channel);
  return static_cast<double>(OrderStatistic(values, values.size() / 20));
}

double BrightestRadiance(const Observations& observations) {
  std::vector<float> values = Values(observations, 0);
  return static_cast<double>(LowerQuantile(values, 0.999));
}

}  // namespace turnlight::estimator::observe
