#include "estimator/observe/observations.h"

#include <algorithm>
#include <cmath>

#include "base/statistics.h"
#include "estimator/observe/keyframe_tracer.h"
#include "estimator/observe/observations_builder.h"
#include "estimator/observe/radiance_statistics.h"

namespace turnlight::estimator::observe {
namespace {

using Eigen::Vector3d;

// What footprints and edges leave even of clean pictures, as a share of the brightest radiance: how
// much dark pixels may count for.
constexpr double kModelFloor = 5e-4;

bool AllWeighted(const std::vector<Observations>& parts) {
  return !parts.empty() && std::all_of(parts.begin(), parts.end(), [](const Observations& part) {
    return part.size() == 0 || !part.variance.empty();
  });
}

}  // namespace

void Observations::Resize(std::size_t size) {
  for (int i = 0; i < 3; ++i) {
    const float unit = i == 2 ? 1.0f : 0.0f;
    position[i].assign(size, 0.0f);
    normal[i].assign(size, unit);
    mirrored[i].assign(size, unit);
    if (i < channels) radiance[i].assign(size, 0.0f);
  }
  for (auto& component : footprint) component.assign(size, 0);
  for (auto& component : step) component.assign(size, 0);
  if (caster != nullptr) {
    for (auto& component : face_normal) component.assign(size, 0.0f);
    keyframe.assign(size, 0);
  }
  pixel.assign(size, Observations::kNoPixel);
  tile_footprint.assign(size / kTile, 0.0f);
}

void SetWeights(Observations& all) {
  all.weight.assign(all.size(), 1.0f);
  if (all.used == 0) return;
  const double floor = kModelFloor * BrightestRadiance(all);
  const auto variance = [&](std::size_t i) {
    return static_cast<float>(static_cast<double>(all.variance[i]) + floor * floor);
  };
  std::vector<float> variances;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all.pixel[i] != Observations::kNoPixel) variances.push_back(variance(i));
  const float reference = Median(variances);
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all.pixel[i] != Observations::kNoPixel && variance(i) > 0.0f)
      all.weight[i] = std::sqrt(reference / variance(i));
}

Observations BuildObservations(const std::vector<model::Keyframe>& keyframes,
                               const target::Geometry& geometry, const calib::RayGrid& rays,
                               std::vector<cv::Mat1b>* flags) {
  ObservationsBuilder builder(geometry, rays, keyframes.size(), kAllPixels);
  if (flags != nullptr) flags->clear();
  const auto put = [&](std::size_t, const model::Keyframe& keyframe, KeyframeTracer& tracer) {
    builder.Add(keyframe, tracer);
    if (flags != nullptr) flags->push_back(tracer.flags());
  };
  // Keyframes in memory can be read, and nothing stops it.
  static_cast<void>(TraceKeyframes(model::SourceOf(keyframes), geometry, rays, nullptr, put));
  return builder.Finish();
}

Observations Concatenate(const std::vector<Observations>& parts) {
  Observations out;
  out.channels = 1;
  Vector3d sum = Vector3d::Zero();
  for (const Observations& part : parts) {
    out.radius = part.radius;
    out.caster = part.caster;
    out.width = part.width;
    out.X_TW.insert(out.X_TW.end(), part.X_TW.begin(), part.X_TW.end());
    if (part.used > 0) out.channels = std::max(out.channels, part.channels);
    out.used += part.used;
    sum += static_cast<double>(part.used) * part.reference;
    out.tile_begin.push_back(out.tile_begin.back() + part.tiles());
  }
  if (out.used > 0) out.reference = sum / static_cast<double>(out.used);
  out.Resize(out.tile_begin.back() * kTile);
  if (AllWeighted(parts)) out.variance.assign(out.size(), 0.0f);
  std::size_t at = 0;
  std::uint32_t first_keyframe = 0;
  const auto put = [&at](const auto& from, auto& to) {
    std::copy(from.begin(), from.end(), to.begin() + static_cast<std::ptrdiff_t>(at));
  };
  for (const Observations& part : parts) {
    const Eigen::Vector3f shift = ((part.reference - out.reference) / out.radius).cast<float>();
    for (int k = 0; k < 3; ++k) {
      for (std::size_t i = 0; i < part.size(); ++i)
        out.position[k][at + i] = part.position[k][i] + shift[k];
      put(part.normal[k], out.normal[k]);
      put(part.mirrored[k], out.mirrored[k]);
      if (k < out.channels) put(part.radiance[part.channels == 1 ? 0 : k], out.radiance[k]);
    }
    for (int k = 0; k < 6; ++k) {
      put(part.footprint[k], out.footprint[k]);
      put(part.step[k], out.step[k]);
    }
    put(part.pixel, out.pixel);
    if (!out.variance.empty()) put(part.variance, out.variance);
    if (out.caster != nullptr) {
      for (int k = 0; k < 3; ++k) put(part.face_normal[k], out.face_normal[k]);
      for (std::size_t i = 0; i < part.size(); ++i)
        out.keyframe[at + i] = part.keyframe[i] + first_keyframe;
      first_keyframe += static_cast<std::uint32_t>(part.X_TW.size());
    }
    std::copy(part.tile_footprint.begin(), part.tile_footprint.end(),
              out.tile_footprint.begin() + static_cast<std::ptrdiff_t>(at / kTile));
    at += part.size();
  }
  if (!out.variance.empty()) SetWeights(out);
  return out;
}

}  // namespace turnlight::estimator::observe
