#include "estimator/residual_maps.h"

#include <limits>
#include <utility>

#include "estimator/solve/prediction.h"

namespace turnlight::estimator {

std::map<std::size_t, cv::Mat1f> ResidualMaps(const observe::Observations& all,
                                              const model::Scene& scene,
                                              const solve::EvaluateOptions& options, cv::Size size,
                                              const std::vector<std::size_t>& keyframes) {
  const auto model = solve::Predict(all, scene, options);
  std::map<std::size_t, cv::Mat1f> maps;
  for (const std::size_t k : keyframes) {
    cv::Mat1f map(size, std::numeric_limits<float>::quiet_NaN());
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
    maps.emplace(k, std::move(map));
  }
  return maps;
}

}  // namespace turnlight::estimator
