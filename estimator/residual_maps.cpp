#include "estimator/residual_maps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/statistics.h"
#include "estimator/solve/coordinates.h"
#include "estimator/solve/footprints.h"
#include "estimator/solve/prediction.h"
#include "estimator/solve/shadows.h"

namespace turnlight::estimator {
namespace {

constexpr double kStandsOut = 3.0;  // times the median

double MedianOfSeen(std::vector<double> rms) {
  std::erase(rms, 0.0);
  return Median(rms);
}

}  // namespace

bool StandsOut(const std::vector<double>& rms, std::size_t keyframe) {
  return rms[keyframe] > kStandsOut * MedianOfSeen(rms);
}

bool OneStandsOut(const std::vector<double>& rms) {
  return !rms.empty() && *std::max_element(rms.begin(), rms.end()) > kStandsOut * MedianOfSeen(rms);
}

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
      if (all.pixel[i] == observe::Observations::kNoPixel || all.IsAtWhite(i)) continue;
      if (options.shadows.usable && (*options.shadows.usable)[i] == 0) continue;
      float sum = 0.0f;
      for (int c = 0; c < all.channels; ++c)
        sum += all.radiance[c][i] - model[static_cast<std::size_t>(c)][i];
      const int at = static_cast<int>(all.pixel[i]);
      map(at / size.width, at % size.width) =
          static_cast<float>(all.radiance_unit) * sum / static_cast<float>(all.channels);
    }
    maps.emplace(k, std::move(map));
  }
  return maps;
}

std::vector<double> RmsByKeyframe(const observe::Observations& all, const model::Scene& scene,
                                  const solve::EvaluateOptions& options) {
  const auto model = solve::Predict(all, scene, options);
  std::vector<double> out;
  for (std::size_t k = 0; k + 1 < all.tile_begin.size(); ++k) {
    double sum = 0.0;
    std::size_t count = 0;
    for (std::size_t i = all.tile_begin[k] * observe::kTile;
         i < all.tile_begin[k + 1] * observe::kTile; ++i) {
      if (all.pixel[i] == observe::Observations::kNoPixel || all.IsAtWhite(i)) continue;
      if (options.shadows.usable && (*options.shadows.usable)[i] == 0) continue;
      for (int c = 0; c < all.channels; ++c, ++count) {
        const auto left =
            static_cast<double>(all.radiance[c][i] - model[static_cast<std::size_t>(c)][i]);
        sum += left * left;
      }
    }
    out.push_back(count > 0 ? all.radiance_unit * std::sqrt(sum / static_cast<double>(count))
                            : 0.0);
  }
  return out;
}

cv::Mat1f ResidualMapOf(const model::Keyframe& keyframe, const target::Geometry& geometry,
                        const calib::RayGrid& rays, const model::Scene& scene) {
  const observe::Observations all = observe::BuildObservations({keyframe}, geometry, rays);
  const model::Scene own = solve::ToSolver(scene, all);
  solve::EvaluateOptions options;
  options.samples_per_side = solve::FootprintSamples(all, own.reflectance, 2);
  options.shadows = solve::CastShadows(all, own);
  return ResidualMaps(all, own, options, {rays.width(), rays.height()}, {0}).at(0);
}

}  // namespace turnlight::estimator
