#include "estimator/observe/views.h"

#include <algorithm>
#include <cmath>

namespace turnlight::estimator::observe {
namespace {

constexpr std::size_t kMostOfPicture = 100'000;  // pixels

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

int DistinctViews(const std::vector<cv::Mat>& signatures, double noise) {
  std::vector<const cv::Mat*> distinct;
  for (const cv::Mat& signature : signatures) {
    const auto same = [&](const cv::Mat* other) {
      if (other->size() != signature.size() || other->type() != signature.type()) return false;
      double sum = 0.0;
      std::size_t count = 0;
      const float* a = signature.ptr<float>();
      const float* b = other->ptr<float>();
      const std::size_t values = signature.total() * static_cast<std::size_t>(signature.channels());
      for (std::size_t i = 0; i < values; ++i) {
        if (!std::isfinite(a[i]) || !std::isfinite(b[i])) continue;
        const double difference = static_cast<double>(a[i]) - static_cast<double>(b[i]);
        sum += difference * difference;
        ++count;
      }
      const double limit = 1.5 * std::sqrt(2.0) * noise + 1e-6;
      return count > 0 && sum <= limit * limit * static_cast<double>(count);
    };
    if (std::none_of(distinct.begin(), distinct.end(), same)) distinct.push_back(&signature);
  }
  return static_cast<int>(distinct.size());
}

}  // namespace turnlight::estimator::observe
