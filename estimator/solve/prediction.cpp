#include "estimator/solve/prediction.h"

#include "base/parallel.h"
#include "estimator/solve/kernel_scene.h"

namespace turnlight::estimator::solve {

Prediction Predict(const observe::Observations& observations, const model::Scene& scene,
                   const EvaluateOptions& options) {
  Prediction out(static_cast<std::size_t>(observations.channels),
                 std::vector<float>(observations.size()));
  const KernelScenes scenes(observations, scene, options);
  ParallelFor(scenes.pieces.size(), [&](std::size_t i) {
    const KernelScenes::Piece& piece = scenes.pieces[i];
    const kernel::KernelModel& model = scenes.scenes[piece.part].model;
    const int channel = scenes.parts[piece.part].channel;
    std::vector<float> workspace(kernel::WorkspaceSize(model.Shared()));
    float* channels[3] = {nullptr, nullptr, nullptr};
    for (std::size_t c = 0; c < static_cast<std::size_t>(model.channels); ++c)
      channels[c] = out[channel == kAll ? c : static_cast<std::size_t>(channel)].data() +
                    piece.first * observe::kTile;
    std::vector<const std::uint8_t*> lit;
    kernel::BestKernel().predict(
        model, PixelsOf(observations, options, piece.first, piece.tiles, channel, lit),
        workspace.data(), channels);
  });
  return out;
}

}  // namespace turnlight::estimator::solve
