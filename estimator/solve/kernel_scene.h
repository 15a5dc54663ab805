// A scene and observations in the form that the kernel takes. Internal to the normal equations and
// the prediction.
#pragma once

#include <cstddef>
#include <vector>

#include "estimator/model/scene.h"
#include "estimator/observe/observations.h"
#include "estimator/solve/evaluate_options.h"
#include "estimator/solve/kernel/tile_kernel.h"

namespace turnlight::estimator::solve {

inline constexpr int kAllChannels = -1;

// The lights live beside the model, which points to them: not to be copied.
struct KernelScene {
  kernel::KernelModel model{};
  std::vector<kernel::KernelLight> lights;

  // channel: the scene as that one channel sees it, each light in its colour there; kAllChannels:
  // all of them under white lights.
  KernelScene(const observe::Observations& observations, const model::Scene& scene,
              const EvaluateOptions& options, int channel = kAllChannels);
  KernelScene(const KernelScene&) = delete;
  KernelScene& operator=(const KernelScene&) = delete;
};

// The channels that have to be looked at one by one, as lights are coloured: 0, 1, 2; or all of
// them at once.
std::vector<int> ChannelsOf(const model::Scene& scene, int channels);

// The arrays of `tiles` tiles from `tile` on, of one channel or all. lit: receives a pointer for
// each light, and must outlive what is returned.
kernel::KernelPixels PixelsOf(const observe::Observations& all, const EvaluateOptions& options,
                              std::size_t tile, std::size_t tiles, int channel,
                              std::vector<const std::uint8_t*>& lit);

// How tiles are shared out to threads: a function of their number alone.
struct Chunks {
  explicit Chunks(std::size_t all_tiles);
  std::size_t count() const { return (tiles + per_chunk - 1) / per_chunk; }
  std::size_t First(std::size_t chunk) const { return chunk * per_chunk; }
  std::size_t Tiles(std::size_t chunk) const;  // in this chunk; the last may have fewer

  std::size_t tiles, per_chunk;
};

}  // namespace turnlight::estimator::solve
