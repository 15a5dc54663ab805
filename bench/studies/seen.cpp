#include "bench/studies/seen.h"

#include <algorithm>
#include <cmath>

#include "estimator/observe/observations.h"
#include "rig/sim/studio.h"

namespace turnlight::studies {
namespace {

using Eigen::Vector3d;
using estimator::model::Light;
using estimator::observe::Observations;

}  // namespace

Result<SeenSurface> SeenSurface::Build(const rig::sim::SyntheticConfig& config) {
  auto studio = rig::sim::BuildStudio(config);
  if (!studio) return Forward(studio);
  std::vector<estimator::model::Keyframe> keyframes;
  const cv::Size size(config.camera.width, config.camera.height);
  SeenSurface out;
  for (int i = 0; i < config.motion.frames; ++i) {
    const calib::RigPoses placement = rig::sim::PlaceAt(config.motion, i * config.motion.step_deg);
    keyframes.push_back({{cv::Mat1f::zeros(size), cv::Mat1b::zeros(size), {}},
                         cv::Mat1b(size, 255),
                         placement.X_WC,
                         placement.X_WT});
    out.X_WT_.push_back(placement.X_WT);
  }
  const Observations all =
      estimator::observe::BuildObservations(keyframes, studio->geometry, studio->rays, nullptr);
  for (std::size_t view = 0; view + 1 < all.tile_begin.size(); ++view)
    for (std::size_t i = all.tile_begin[view] * estimator::observe::kTile;
         i < all.tile_begin[view + 1] * estimator::observe::kTile; ++i) {
      if (all.pixel[i] == Observations::kNoPixel) continue;
      const auto vector = [i](const std::array<std::vector<float>, 3>& v) {
        return Vector3d(v[0][i], v[1][i], v[2][i]);
      };
      out.pixels_.push_back({all.reference + all.radius * vector(all.position), vector(all.normal),
                             vector(all.mirrored), static_cast<int>(view)});
    }
  out.geometry_ = std::make_shared<estimator::target::Geometry>(std::move(studio->geometry));
  return out;
}

bool SeenSurface::Shadowed(const SeenPixel& pixel, const Vector3d& to_light,
                           double distance) const {
  if (!geometry_->CanShadowItself()) return false;
  const calib::Pose X_TW = X_WT_[static_cast<std::size_t>(pixel.view)].Inverse();
  return geometry_->Occluded(X_TW * pixel.position, X_TW.rotation * pixel.normal,
                             X_TW.rotation * to_light, distance);
}

int SeenSurface::ViewsOfHighlight(const Light& light, double shininess, int min_pixels) const {
  const double half = std::exp2(-1.0 / shininess);
  std::vector<int> count(X_WT_.size(), 0);
  for (const SeenPixel& pixel : pixels_) {
    const Vector3d towards = light.Toward(pixel.position);
    const double length = towards.norm();
    if (towards.dot(pixel.mirrored) < half * length || towards.dot(pixel.normal) <= 0.0) continue;
    int& of_view = count[static_cast<std::size_t>(pixel.view)];
    if (of_view >= min_pixels) continue;
    const double distance = length / light.inverse_distance;  // infinite for a distant light
    of_view += Shadowed(pixel, towards / length, distance) ? 0 : 1;
  }
  return static_cast<int>(
      std::count_if(count.begin(), count.end(), [&](int c) { return c >= min_pixels; }));
}

double SeenSurface::Brightest(const estimator::model::Scene& scene) const {
  double brightest = 0.0;
  for (const SeenPixel& pixel : pixels_) {
    const Vector3d to_viewer =
        2.0 * pixel.normal.dot(pixel.mirrored) * pixel.normal - pixel.mirrored;
    brightest = std::max(brightest, estimator::model::Shade(scene, pixel.position, pixel.normal,
                                                            to_viewer.normalized())
                                        .maxCoeff());
  }
  return brightest;
}

double SeenSurface::HighlightPeak(const estimator::model::Scene& scene, const Light& light) const {
  double peak = 0.0;
  for (const SeenPixel& pixel : pixels_) {
    const Vector3d towards = light.Toward(pixel.position);
    const double length = towards.norm();
    const double cosine = towards.dot(pixel.mirrored) / length;
    if (cosine <= 0.0 || towards.dot(pixel.normal) <= 0.0) continue;
    peak =
        std::max(peak, scene.reflectance.lobes[0].strength * light.intensity / (length * length) *
                           std::pow(cosine, scene.reflectance.lobes[0].shape));
  }
  return peak;
}

}  // namespace turnlight::studies
