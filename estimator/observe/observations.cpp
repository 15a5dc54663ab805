#include "estimator/observe/observations.h"

#include <algorithm>
#include <cmath>

#include "base/statistics.h"
#include "estimator/observe/keyframe_tracer.h"
#include "estimator/observe/observations_builder.h"
#include "estimator/observe/radiance_statistics.h"
#include "estimator/observe/radiance_unit.h"

namespace turnlight::estimator::observe {
namespace {

using Eigen::Vector3d;

// What footprints and edges leave even of clean pictures, as a share of the brightest radiance: how
// much dark pixels may count for.
constexpr double kModelFloor = 5e-4;

bool AllWeighted(const std::vector<Observations>& parts) {
  return !parts.empty() && std::all_of(parts.begin(), parts.end(), [](const Observations& part) {
    return part.size() == 0 || part.weighted;
  });
}

float VarianceOf(const Observations& all, std::size_t i) {
  return static_cast<float>(static_cast<double>(all.variance[i]) + all.floor_variance);
}

void SetWeightsByReference(Observations& all) {
  const auto reference = static_cast<float>(all.reference_variance);
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all.pixel[i] != Observations::kNoPixel && VarianceOf(all, i) > 0.0f)
      all.weight[i] = std::sqrt(reference / VarianceOf(all, i));
}

void SetWeights(Observations& all) {
  if (all.used == 0) return;
  const double floor = kModelFloor * BrightestRadiance(all);
  all.floor_variance = floor * floor;
  std::vector<float> variances;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all.pixel[i] != Observations::kNoPixel) variances.push_back(VarianceOf(all, i));
  all.reference_variance = Median(variances);
  SetWeightsByReference(all);
}

// A part into its place from `at` on: positions about the centroid of all, keyframes after those of
// the parts before it.
void PutPart(const Observations& part, std::size_t at, std::uint32_t first_keyframe,
             Observations& out) {
  const auto put = [](const auto& from, std::size_t begin, auto& to) {
    std::copy(from.begin(), from.end(), to.begin() + static_cast<std::ptrdiff_t>(begin));
  };
  ForEachOwnPlane([&](auto, auto& to, const auto& from) { put(from, at, to); }, out, part);
  put(part.tile_footprint, at / kTile, out.tile_footprint);
  const Eigen::Vector3f shift = ((part.reference - out.reference) / out.radius).cast<float>();
  for (int k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < part.size(); ++i)
      out.position[k][at + i] = part.position[k][i] + shift[k];
  for (int c = part.channels; c < out.channels; ++c) put(part.radiance[0], at, out.radiance[c]);
  if (out.caster == nullptr) return;
  for (std::size_t i = 0; i < part.size(); ++i) out.keyframe[at + i] += first_keyframe;
}

Observations BuildInWhite(const std::vector<model::Keyframe>& keyframes,
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

}  // namespace

void Observations::Resize(std::size_t size) {
  ForEachPlane([size](auto filling, auto& plane) { plane.assign(size, filling); }, *this);
  tile_footprint.assign(size / kTile, 0.0f);
}

void Complete(Observations& observations) {
  SetRadianceUnit(observations);
  if (observations.weighted) SetWeights(observations);
}

ObservationFrame FrameOf(const Observations& observations) {
  return {observations.reference,     observations.radius,   observations.radiance_unit,
          observations.channels,      observations.weighted, observations.reference_variance,
          observations.floor_variance};
}

void CompleteIn(const ObservationFrame& frame, Observations& part) {
  const Eigen::Vector3f shift = ((part.reference - frame.reference) / frame.radius).cast<float>();
  for (int k = 0; k < 3; ++k)
    for (float& value : part.position[k]) value += shift[k];
  part.reference = frame.reference;
  for (int c = part.channels; c < frame.channels; ++c) part.radiance[c] = part.radiance[0];
  part.channels = frame.channels;
  part.radiance_unit = frame.radiance_unit;
  for (int c = 0; c < part.channels; ++c)
    for (float& value : part.radiance[c]) value *= static_cast<float>(1.0 / frame.radiance_unit);
  if (!frame.weighted) return DropWeights(part);
  for (float& value : part.variance)
    value *= static_cast<float>(1.0 / (frame.radiance_unit * frame.radiance_unit));
  part.reference_variance = frame.reference_variance;
  part.floor_variance = frame.floor_variance;
  SetWeightsByReference(part);
}

void TakeHeldBack(Observations& observations) {
  observations.one_sided = true;
  observations.at_white.assign(observations.size(), 0);
  for (const HeldBack& held : observations.held_back) {
    observations.pixel[held.at] = held.pixel;
    observations.at_white[held.at] = held.at_white;
  }
  observations.used += observations.held_back.size();
  if (observations.weighted) SetWeightsByReference(observations);
}

void HoldBack(Observations& observations) {
  for (const HeldBack& held : observations.held_back)
    observations.pixel[held.at] = Observations::kNoPixel;
  observations.used -= observations.held_back.size();
  if (observations.held_back.empty()) return;
  observations.one_sided = false;
  observations.at_white = {};
}

void DropWeights(Observations& observations) {
  observations.weighted = false;
  observations.variance = {};
  observations.weight = {};
}

Observations BuildObservations(const std::vector<model::Keyframe>& keyframes,
                               const target::Geometry& geometry, const calib::RayGrid& rays,
                               std::vector<cv::Mat1b>* flags) {
  Observations out = BuildInWhite(keyframes, geometry, rays, flags);
  Complete(out);
  return out;
}

Observations BuildPart(const model::Keyframe& keyframe, const target::Geometry& geometry,
                       const calib::RayGrid& rays) {
  return BuildInWhite({keyframe}, geometry, rays, nullptr);
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
  out.weighted = AllWeighted(parts);
  out.Resize(out.tile_begin.back() * kTile);
  std::uint32_t first_keyframe = 0;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    PutPart(parts[k], out.tile_begin[k] * kTile, first_keyframe, out);
    for (HeldBack held : parts[k].held_back) {
      held.at += out.tile_begin[k] * kTile;
      out.held_back.push_back(held);
    }
    first_keyframe += static_cast<std::uint32_t>(parts[k].X_TW.size());
  }
  Complete(out);
  return out;
}

}  // namespace turnlight::estimator::observe
