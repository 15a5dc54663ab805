#include "estimator/observe/sampling.h"

#include <algorithm>
#include <cmath>

#include "base/random.h"

namespace turnlight::estimator::observe {
namespace {

// How much a pixel tells: its difference from its neighbours in the row, in grey.
std::vector<float> RowGradient(const Observations& all) {
  std::vector<float> gradient(all.size(), 0.0f);
  const auto grey = [&](std::size_t i) {
    float sum = 0.0f;
    for (int c = 0; c < all.channels; ++c) sum += all.radiance[c][i];
    return sum / static_cast<float>(all.channels);
  };
  for (std::size_t i = 1; i + 1 < all.size(); ++i)
    if (all.pixel[i] != Observations::kNoPixel && all.pixel[i - 1] + 1 == all.pixel[i] &&
        all.pixel[i] + 1 == all.pixel[i + 1])
      gradient[i] = std::abs(grey(i + 1) - grey(i - 1));
  return gradient;
}

constexpr std::size_t kFilling = static_cast<std::size_t>(-1);

// Where each pixel of a subset comes from, whole tiles for each keyframe; kFilling for none.
std::vector<std::size_t> ByKeyframe(const Observations& all, const std::vector<std::size_t>& picked,
                                    std::vector<std::size_t>& tile_begin) {
  std::vector<std::size_t> from;
  std::size_t next = 0;
  for (std::size_t k = 0; k + 1 < all.tile_begin.size(); ++k) {
    while (next < picked.size() && picked[next] / kTile < all.tile_begin[k + 1])
      from.push_back(picked[next++]);
    from.resize((from.size() + kTile - 1) / kTile * kTile, kFilling);
    tile_begin.push_back(from.size() / kTile);
  }
  return from;
}

// The pixels at these places.
Observations Picked(const Observations& all, std::vector<std::size_t> picked, bool by_keyframe) {
  Observations out;
  out.channels = all.channels;
  out.reference = all.reference;
  out.radius = all.radius;
  out.radiance_unit = all.radiance_unit;
  out.weighted = all.weighted;
  out.one_sided = all.one_sided;
  out.caster = all.caster;
  out.width = all.width;
  out.X_TW = all.X_TW;
  out.subsampled = true;
  out.used = picked.size();
  if (by_keyframe)
    picked = ByKeyframe(all, picked, out.tile_begin);
  else
    out.tile_begin.push_back((picked.size() + kTile - 1) / kTile);
  out.Resize(out.tile_begin.back() * kTile);
  const auto gather = [&picked](auto, const auto& from, auto& to) {
    for (std::size_t i = 0; i < picked.size(); ++i)
      if (picked[i] != kFilling) to[i] = from[picked[i]];
  };
  ForEachPlane(gather, all, out);
  for (std::size_t i = 0; i < picked.size(); ++i) {
    if (picked[i] == kFilling) continue;
    out.tile_footprint[i / kTile] =
        std::max(out.tile_footprint[i / kTile], all.tile_footprint[picked[i] / kTile]);
  }
  return out;
}

// Of each pixel the place that it would have if nothing were held back: what is held back changes
// nothing of which others are picked.
std::vector<std::uint32_t> PlacesWithoutHeldBack(const Observations& all) {
  std::vector<std::uint32_t> place(all.size(), 0);
  std::size_t next = 0;
  for (std::size_t k = 0; k + 1 < all.tile_begin.size(); ++k) {
    for (std::size_t i = all.tile_begin[k] * kTile; i < all.tile_begin[k + 1] * kTile; ++i)
      if (all.pixel[i] != Observations::kNoPixel) place[i] = static_cast<std::uint32_t>(next++);
    next = (next + kTile - 1) / kTile * kTile;
  }
  return place;
}

std::vector<std::size_t> PickEvenly(const Observations& all, std::size_t count, std::uint64_t seed,
                                    const std::vector<std::uint8_t>* usable) {
  const auto used = [&](std::size_t i) {
    return all.pixel[i] != Observations::kNoPixel && (usable == nullptr || (*usable)[i] != 0);
  };
  std::size_t total = 0;
  for (std::size_t i = 0; i < all.size(); ++i) total += used(i) ? 1 : 0;
  const RandomStream random(seed, 0);
  const std::vector<std::uint32_t> place = PlacesWithoutHeldBack(all);
  std::vector<std::size_t> picked;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (used(i) &&
        random.Uniform(place[i]) * static_cast<double>(total) < static_cast<double>(count))
      picked.push_back(i);
  return picked;
}

}  // namespace

Observations Subsample(const Observations& all, std::size_t count, std::uint64_t seed,
                       bool by_keyframe) {
  const std::vector<float> gradient = RowGradient(all);
  double mean = 0.0;
  for (const float value : gradient) mean += value;
  mean = std::max(mean / static_cast<double>(std::max<std::size_t>(all.used, 1)), 1e-12);
  const auto weight = [&](std::size_t i) {
    return 0.5 + 0.5 * std::min(static_cast<double>(gradient[i]) / mean, 20.0);
  };
  double total = 0.0;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all.pixel[i] != Observations::kNoPixel) total += weight(i);
  const RandomStream random(seed, 0);
  const std::vector<std::uint32_t> place = PlacesWithoutHeldBack(all);
  std::vector<std::size_t> picked;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all.pixel[i] != Observations::kNoPixel &&
        random.Uniform(place[i]) * total < weight(i) * static_cast<double>(count))
      picked.push_back(i);
  return Picked(all, picked, by_keyframe);
}

Observations EvenSubsample(const Observations& all, std::size_t count, std::uint64_t seed,
                           const std::vector<std::uint8_t>* usable, bool by_keyframe) {
  return Picked(all, PickEvenly(all, count, seed, usable), by_keyframe);
}

PixelSample SampleOfKeyframes(const Observations& all, std::size_t count, std::uint64_t seed,
                              const std::vector<std::uint8_t>* usable, bool by_keyframe) {
  std::vector<std::size_t> picked = PickEvenly(all, count, seed, usable);
  PixelSample out{Picked(all, picked, by_keyframe), {}};
  out.keyframe.assign(out.pixels.size(), 0);
  std::vector<std::size_t> tile_begin;
  if (by_keyframe) picked = ByKeyframe(all, picked, tile_begin);
  std::uint32_t keyframe = 0;
  for (std::size_t i = 0; i < picked.size(); ++i) {
    if (picked[i] == kFilling) continue;
    while (picked[i] / kTile >= all.tile_begin[keyframe + 1]) ++keyframe;
    out.keyframe[i] = keyframe;
  }
  return out;
}

}  // namespace turnlight::estimator::observe
