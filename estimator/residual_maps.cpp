#include "estimator/residual_maps.h"

#include <limits>

#include "estimator/solve/prediction.h"

namespace turnlight::estimator {

std::vector<cv::Mat1f> ResidualMaps(const observe::Observations& all, const model::Scene& scene,
                                    const solve::EvaluateOptions& options, cv::Size size) {
  const auto model = solve::Predict(all, scene, options);
  std::vector<cv::Mat1f> maps;
  for (std::size_t k = 0; k + 1 < all.tile_begin.size(); ++k) {
    cv::Mat1f& map = maps.emplace_back(size, std::numeric_limits<float>::quiet_NaN());
    for (std::size_t i = all.tile_begin[k] * observe::kTile;
         i < all.tile_begin[k + 1] * observe::kTile; ++i) {
      if (all.pixel[i] == observe::Observations::kNoPixel) continue;
      if (options.shadows.usable && (*options.shadows.usable)[i] == 0) continue;
      float sum = 0.0f;
      for (int c = 0; c < all.channels; ++c)
        sum += all.radiance[c][i] - model[static_cast<std::size_t>(c)][i];
      const int at = static_cast<int>(all.pixel[i]);
      map(at / size.width, at % size.width) = sum / static_cast<float>(all.channels);
    }
  }
  return maps;
}

}  // namespace turnlight::estimator
