#include "estimator/observe/observations.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/statistics.h"
#include "estimator/observe/radiance_statistics.h"

namespace turnlight::estimator::observe {
namespace {

using Eigen::Vector3d;

bool ChannelsAreEqual(const std::vector<model::Keyframe>& keyframes) {
  for (const model::Keyframe& keyframe : keyframes) {
    const cv::Mat& image = keyframe.image.radiance;
    if (image.channels() == 1) continue;
    const cv::Mat3f colour = image;
    for (const cv::Vec3f& value : colour)
      if (value[0] != value[1] || value[1] != value[2]) return false;
  }
  return true;
}

// What footprints and edges leave even of clean pictures, as a share of the brightest radiance: how
// much dark pixels may count for.
constexpr double kModelFloor = 5e-4;

// The weights from the variances of all, if there are any.
void SetWeights(Observations& all) {
  if (all.variance.empty() || all.used == 0) return;
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

bool AllWeighted(const std::vector<Observations>& parts) {
  return !parts.empty() && std::all_of(parts.begin(), parts.end(), [](const Observations& part) {
    return part.size() == 0 || !part.variance.empty();
  });
}

void AllowForNoise(Observations& all) {
  all.variance.assign(all.size(), 0.0f);
  all.weight.assign(all.size(), 1.0f);
}

void Pack(const model::Keyframe& keyframe, const FramePixels& frame, std::uint32_t index,
          Observations& out) {
  const std::size_t first_tile = out.tile_begin[index];
  const cv::Mat& image = keyframe.image.radiance;
  for (std::size_t i = 0; i < frame.pixel.size(); ++i) {
    const std::size_t at = first_tile * kTile + i;
    const PixelGeometry& g = frame.geometry[i];
    const Vector3d x = (g.position - out.reference) / out.radius;
    for (int k = 0; k < 3; ++k) {
      out.position[k][at] = static_cast<float>(x[k]);
      out.normal[k][at] = static_cast<float>(g.normal[k]);
      out.mirrored[k][at] = static_cast<float>(g.mirrored[k]);
      out.footprint[k][at] = ToBFloat16(static_cast<float>(g.dw_du[k]));
      out.footprint[3 + k][at] = ToBFloat16(static_cast<float>(g.dw_dv[k]));
      out.step[k][at] = ToBFloat16(static_cast<float>(g.dx_du[k] / out.radius));
      out.step[3 + k][at] = ToBFloat16(static_cast<float>(g.dx_dv[k] / out.radius));
    }
    const int row = static_cast<int>(frame.pixel[i]) / image.cols;
    const int column = static_cast<int>(frame.pixel[i]) % image.cols;
    const float* value =
        image.ptr<float>(row) + static_cast<std::ptrdiff_t>(column) * image.channels();
    for (int c = 0; c < out.channels; ++c) out.radiance[c][at] = value[c];
    if (!out.variance.empty()) out.variance[at] = keyframe.image.variance(row, column);
    if (out.caster != nullptr) {
      out.keyframe[at] = index;
      for (int k = 0; k < 3; ++k) out.face_normal[k][at] = static_cast<float>(g.face_normal[k]);
    }
    out.pixel[at] = frame.pixel[i];
    float& largest = out.tile_footprint[at / kTile];
    largest = std::max(largest, static_cast<float>(g.dw_du.norm() + g.dw_dv.norm()));
  }
}

}  // namespace

void Observations::Resize(std::size_t size) {
  for (int i = 0; i < 3; ++i) {
    // Filling has a unit normal and view, so that nothing it computes before its weight of 0 is
    // NaN.
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

Observations BuildObservations(const std::vector<model::Keyframe>& keyframes,
                               const target::Geometry& geometry, const calib::RayGrid& rays,
                               std::vector<cv::Mat1b>* flags) {
  std::vector<FramePixels> frames(keyframes.size());
  ParallelFor(keyframes.size(),
              [&](std::size_t k) { frames[k] = TraceKeyframe(keyframes[k], geometry, rays); });
  Observations out;
  out.radius = geometry.radius();
  out.channels = ChannelsAreEqual(keyframes) ? 1 : 3;
  if (geometry.CanShadowItself()) {
    out.caster = &geometry;
    out.width = rays.width();
    for (const model::Keyframe& keyframe : keyframes) out.X_TW.push_back(keyframe.X_WT.Inverse());
  }
  Vector3d sum = Vector3d::Zero();
  for (const FramePixels& frame : frames) {
    for (const PixelGeometry& pixel : frame.geometry) sum += pixel.position;
    out.used += frame.pixel.size();
    out.tile_begin.push_back(out.tile_begin.back() + (frame.pixel.size() + kTile - 1) / kTile);
  }
  if (out.used > 0) out.reference = sum / static_cast<double>(out.used);
  out.Resize(out.tile_begin.back() * kTile);
  if (!keyframes.empty() &&
      std::none_of(keyframes.begin(), keyframes.end(),
                   [](const model::Keyframe& keyframe) { return keyframe.image.variance.empty(); }))
    AllowForNoise(out);
  ParallelFor(keyframes.size(), [&](std::size_t k) {
    Pack(keyframes[k], frames[k], static_cast<std::uint32_t>(k), out);
  });
  SetWeights(out);
  if (flags) {
    flags->clear();
    for (FramePixels& frame : frames) flags->push_back(std::move(frame.flags));
  }
  return out;
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
  if (AllWeighted(parts)) AllowForNoise(out);
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
  SetWeights(out);
  return out;
}

}  // namespace turnlight::estimator::observe
