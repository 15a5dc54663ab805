#include "estimator/solve/prediction.h"

#include "base/parallel.h"
#include "estimator/solve/kernel_scene.h"

namespace turnlight::estimator::solve {

Prediction Predict(const observe::Observations& observations, const model::Scene& scene,
                   const EvaluateOptions& options) {
  Prediction out(static_cast<std::size_t>(observations.channels),
                 std::vector<float>(observations.size()));
  const Chunks chunks(observations.tiles());
  for (const int channel : ChannelsOf(scene, observations.channels)) {
    const KernelScene kernel_scene(observations, scene, options, channel);
    ParallelFor(chunks.count(), [&](std::size_t chunk) {
      const std::size_t first = chunks.First(chunk), tiles = chunks.Tiles(chunk);
      std::vector<float> workspace(kernel::WorkspaceSize(kernel_scene.model.Shared()));
      float* channels[3] = {nullptr, nullptr, nullptr};
      for (std::size_t c = 0; c < static_cast<std::size_t>(kernel_scene.model.channels); ++c)
        channels[c] = out[channel == kAllChannels ? c : static_cast<std::size_t>(channel)].data() +
                      first * observe::kTile;
      std::vector<const std::uint8_t*> lit;
      kernel::BestKernel().predict(kernel_scene.model,
                                   PixelsOf(observations, options, first, tiles, channel, lit),
                                   workspace.data(), channels);
    });
  }
  return out;
}

}  // namespace turnlight::estimator::solve
