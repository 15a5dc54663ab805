#include "estimator/observe/views.h"

#include <algorithm>
#include <cmath>

namespace turnlight::estimator::observe {

cv::Mat ViewSignature(const model::Keyframe& keyframe) {
  constexpr int kStep = 3;
  const cv::Mat& image = keyframe.image.radiance;
  cv::Mat out((image.rows + kStep - 1) / kStep, (image.cols + kStep - 1) / kStep, image.type());
  for (int row = 0; row < out.rows; ++row)
    for (int column = 0; column < out.cols; ++column)
      std::copy_n(image.ptr<float>(kStep * row) + kStep * column * image.channels(),
                  image.channels(), out.ptr<float>(row) + column * image.channels());
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
