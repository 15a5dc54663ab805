#include "estimator/solve/normal_equations.h"

#include <utility>
#include <vector>

#include "base/parallel.h"
#include "estimator/solve/kernel_scene.h"

namespace turnlight::estimator::solve {
namespace {

using kernel::KernelModel;
using kernel::KernelSums;

// The sums of one chunk, with their storage.
struct ChunkSums {
  std::vector<double> values;
  KernelSums sums{};

  explicit ChunkSums(int n) : values(static_cast<std::size_t>(n) * (n + 3), 0.0) {
    sums.shared = values.data();
    sums.gradient = sums.shared + static_cast<std::ptrdiff_t>(n) * n;
    sums.albedo_a = sums.gradient + n;
    sums.albedo_b = sums.albedo_a + n;
  }
  void Add(const ChunkSums& other, int channels) {
    for (std::size_t i = 0; i < values.size(); ++i) values[i] += other.values[i];
    sums.albedo_square += other.sums.albedo_square;
    for (int c = 0; c < channels; ++c) sums.albedo_gradient[c] += other.sums.albedo_gradient[c];
    sums.cost += other.sums.cost;
  }
};

NormalEquations Assemble(const KernelModel& model, const KernelSums& sums) {
  const int n = model.Shared(), channels = model.channels;
  NormalEquations out;
  out.cost = sums.cost;
  out.hessian = Eigen::MatrixXd::Zero(channels + n, channels + n);
  out.gradient = Eigen::VectorXd::Zero(channels + n);
  for (int i = 0; i < n; ++i) {
    out.gradient[channels + i] = sums.gradient[i];
    for (int j = i; j < n; ++j)
      out.hessian(channels + i, channels + j) = out.hessian(channels + j, channels + i) =
          sums.shared[i * n + j];
    for (int c = 0; c < channels; ++c)
      out.hessian(c, channels + i) = out.hessian(channels + i, c) =
          model.albedo[c] * sums.albedo_a[i] + sums.albedo_b[i];
  }
  for (int c = 0; c < channels; ++c) {
    out.hessian(c, c) = sums.albedo_square;
    out.gradient[c] = sums.albedo_gradient[c];
  }
  return out;
}

// What one channel's columns are of the scene's, by the chain rule: what the channel takes for the
// strength of a light, of ambient light or of a lobe is that strength times a colour.
Eigen::MatrixXd MapOf(const model::Scene& scene, const model::Parameters& parameters, int rows,
                      int channel) {
  Eigen::MatrixXd map = Eigen::MatrixXd::Zero(1 + rows, parameters.count());
  map(0, parameters.Albedo(channel)) = 1.0;
  for (int row = 0; row < rows; ++row) map(1 + row, parameters.channels() + row) = 1.0;
  for (int l = 0; l < parameters.lights(); ++l) {
    const model::Light& light = scene.lights[static_cast<std::size_t>(l)];
    const int row = 1 + parameters.Intensity(l) - parameters.channels();
    map(row, parameters.Intensity(l)) = light.color[channel];
    if (const int colour = parameters.Colour(l, channel); colour >= 0)
      map(row, colour) = light.intensity;
  }
  const model::Reflectance& r = scene.reflectance;
  const auto row = [&](int column) { return 1 + column - parameters.channels(); };
  map(row(parameters.Ambient()), parameters.Ambient()) = r.ambient_colour[channel];
  if (const int colour = parameters.AmbientColour(channel); colour >= 0)
    map(row(parameters.Ambient()), colour) = r.ambient;
  for (int k = 0; k < parameters.lobes(); ++k) {
    const int strength = parameters.Strength(k);
    map(row(strength), strength) = r.specular_colour[channel];
    if (const int colour = parameters.SpecularColour(channel); colour >= 0)
      map(row(strength), colour) = r.lobes[static_cast<std::size_t>(k)].strength;
  }
  return map;
}

template <typename Real, typename Function>
NormalEquations EvaluateChannel(const observe::Observations& observations,
                                const model::Scene& scene, const EvaluateOptions& options,
                                int channel, Function accumulate) {
  const KernelScene kernel_scene(observations, scene, options, channel);
  const int n = kernel_scene.model.Shared();
  const Chunks chunks(observations.tiles());
  std::vector<ChunkSums> parts;
  parts.reserve(chunks.count());
  for (std::size_t i = 0; i < chunks.count(); ++i) parts.emplace_back(n);
  ParallelFor(chunks.count(), [&](std::size_t chunk) {
    const std::size_t first = chunks.First(chunk), tiles = chunks.Tiles(chunk);
    std::vector<Real> workspace(kernel::WorkspaceSize(n));
    std::vector<const std::uint8_t*> lit;
    accumulate(kernel_scene.model, PixelsOf(observations, options, first, tiles, channel, lit),
               workspace.data(), parts[chunk].sums);
  });
  ChunkSums total(n);
  for (const ChunkSums& part : parts) total.Add(part, kernel_scene.model.channels);
  NormalEquations out = Assemble(kernel_scene.model, total.sums);
  if (channel == kAllChannels) return out;
  const Eigen::MatrixXd map =
      MapOf(scene, model::Parameters(scene, observations.channels), n, channel);
  return {map.transpose() * out.hessian * map, map.transpose() * out.gradient, out.cost};
}

template <typename Real, typename Function>
NormalEquations EvaluateWith(const observe::Observations& observations, const model::Scene& scene,
                             const EvaluateOptions& options, Function accumulate) {
  NormalEquations sum;
  for (const int channel : ChannelsOf(scene, observations.channels)) {
    NormalEquations of = EvaluateChannel<Real>(observations, scene, options, channel, accumulate);
    if (sum.gradient.size() == 0) {
      sum = std::move(of);
      continue;
    }
    sum.hessian += of.hessian;
    sum.gradient += of.gradient;
    sum.cost += of.cost;
  }
  return sum;
}

}  // namespace

NormalEquations Evaluate(const observe::Observations& observations, const model::Scene& scene,
                         const EvaluateOptions& options) {
  return EvaluateWith<float>(observations, scene, options, kernel::BestKernel().accumulate);
}

Eigen::MatrixXd TileGradients(const observe::Observations& observations, const model::Scene& scene,
                              const EvaluateOptions& options) {
  EvaluateOptions gradient_only = options;
  gradient_only.gradient_only = true;
  const model::Parameters parameters(scene, observations.channels);
  Eigen::MatrixXd out =
      Eigen::MatrixXd::Zero(parameters.count(), static_cast<Eigen::Index>(observations.tiles()));
  for (const int channel : ChannelsOf(scene, observations.channels)) {
    const KernelScene kernel_scene(observations, scene, gradient_only, channel);
    const int n = kernel_scene.model.Shared();
    Eigen::MatrixXd map;
    if (channel != kAllChannels) map = MapOf(scene, parameters, n, channel);
    ParallelFor(observations.tiles(), [&](std::size_t tile) {
      std::vector<float> workspace(kernel::WorkspaceSize(n));
      std::vector<const std::uint8_t*> lit;
      ChunkSums chunk(n);
      kernel::BestKernel().accumulate(kernel_scene.model,
                                      PixelsOf(observations, options, tile, 1, channel, lit),
                                      workspace.data(), chunk.sums);
      const Eigen::VectorXd gradient = Assemble(kernel_scene.model, chunk.sums).gradient;
      const auto at = static_cast<Eigen::Index>(tile);
      if (channel == kAllChannels)
        out.col(at) = gradient;
      else
        out.col(at) += map.transpose() * gradient;
    });
  }
  return out;
}

NormalEquations EvaluateDouble(const observe::Observations& observations, const model::Scene& scene,
                               const EvaluateOptions& options) {
  return EvaluateWith<double>(observations, scene, options, kernel::AccumulateInDouble);
}

}  // namespace turnlight::estimator::solve
