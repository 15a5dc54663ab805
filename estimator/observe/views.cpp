#include "estimator/observe/views.h"

#include <algorithm>
#include <cmath>

namespace turnlight::estimator::observe {
namespace {

constexpr std::size_t kMostOfPicture = 100'000;  // pixels

bool AreAlike(const cv::Mat& one, const cv::Mat& other, double limit) {
  if (other.size() != one.size() || other.type() != one.type()) return false;
  double sum = 0.0;
  std::size_t count = 0;
  const float* a = one.ptr<float>();
  const float* b = other.ptr<float>();
  const std::size_t values = one.total() * static_cast<std::size_t>(one.channels());
  for (std::size_t i = 0; i < values; ++i) {
    if (!std::isfinite(a[i]) || !std::isfinite(b[i])) continue;
    const double difference = static_cast<double>(a[i]) - static_cast<double>(b[i]);
    sum += difference * difference;
    ++count;
  }
  return count > 0 && sum <= limit * limit * static_cast<double>(count);
}

}  // namespace

cv::Mat ViewSignature(const model::Keyframe& keyframe) {
  const cv::Mat& image = keyframe.image.radiance;
  int step = 3;
  while (image.total() > kMostOfPicture * static_cast<std::size_t>(step * step)) ++step;
  cv::Mat out((image.rows + step - 1) / step, (image.cols + step - 1) / step, image.type());
  for (int row = 0; row < out.rows; ++row)
    for (int column = 0; column < out.cols; ++column)
      std::copy_n(image.ptr<float>(step * row) + step * column * image.channels(), image.channels(),
                  out.ptr<float>(row) + column * image.channels());
  return out;
}

double LikeLimit(double noise) { return 1.5 * std::sqrt(2.0) * noise + 1e-6; }

std::vector<std::pair<int, int>> LikeViews(const std::vector<cv::Mat>& signatures, double limit) {
  std::vector<int> distinct;
  std::vector<std::pair<int, int>> like;
  for (int k = 0; k < static_cast<int>(signatures.size()); ++k) {
    const auto earlier = std::find_if(distinct.begin(), distinct.end(), [&](int other) {
      return AreAlike(signatures[k], signatures[other], limit);
    });
    if (earlier == distinct.end())
      distinct.push_back(k);
    else
      like.emplace_back(k, *earlier);
  }
  return like;
}

int DistinctViews(const std::vector<cv::Mat>& signatures, double limit) {
  return static_cast<int>(signatures.size() - LikeViews(signatures, limit).size());
}

}  // namespace turnlight::estimator::observe
