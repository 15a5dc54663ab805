// A scene and observations in the form that the kernel takes. Internal to the normal equations and
// the prediction.
#pragma once

#include <cstddef>
#include <deque>
#include <vector>

#include "estimator/model/scene.h"
#include "estimator/observe/observations.h"
#include "estimator/solve/evaluate_options.h"
#include "estimator/solve/kernel/tile_kernel.h"

namespace turnlight::estimator::solve {

inline constexpr int kAll = -1;

// A part of the observations that is a problem of its own, as what multiplies its lights is: one
// channel under coloured lights, one keyframe under lights that change.
struct Part {
  int channel = kAll;
  int keyframe = kAll;
  std::size_t first = 0, tiles = 0;
};
// In a fixed order, a keyframe's channels together.
std::vector<Part> PartsOf(const model::Scene& scene, const observe::Observations& observations);

// The lights live beside the model, which points to them: not to be copied.
struct KernelScene {
  kernel::KernelModel model{};
  std::vector<kernel::KernelLight> lights;

  // The scene as that part sees it, each light in its colour and with its factor there.
  KernelScene(const observe::Observations& observations, const model::Scene& scene,
              const EvaluateOptions& options, const Part& part = {});
  KernelScene(const KernelScene&) = delete;
  KernelScene& operator=(const KernelScene&) = delete;
};

// The arrays of `tiles` tiles from `tile` on, of one channel or all. lit: receives a pointer for
// each light, and must outlive what is returned.
kernel::KernelPixels PixelsOf(const observe::Observations& all, const EvaluateOptions& options,
                              std::size_t tile, std::size_t tiles, int channel,
                              std::vector<const std::uint8_t*>& lit);

// A scene for each part, and the work on them in pieces for threads.
struct KernelScenes {
  struct Piece {
    std::size_t part, first, tiles;
  };
  std::vector<Part> parts;
  std::deque<KernelScene> scenes;
  std::vector<Piece> pieces;

  KernelScenes(const observe::Observations& observations, const model::Scene& scene,
               const EvaluateOptions& options);
};

// How tiles are shared out to threads: a function of their number alone.
struct Chunks {
  explicit Chunks(std::size_t all_tiles);
  std::size_t count() const { return (tiles + per_chunk - 1) / per_chunk; }
  std::size_t First(std::size_t chunk) const { return chunk * per_chunk; }
  std::size_t Tiles(std::size_t chunk) const;  // in this chunk; the last may have fewer

  std::size_t tiles, per_chunk;
};

}  // namespace turnlight::estimator::solve
