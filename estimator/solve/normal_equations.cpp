#include "estimator/solve/normal_equations.h"

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "estimator/solve/frame_factors.h"
#include "estimator/solve/kernel_scene.h"

namespace turnlight::estimator::solve {
namespace {

using kernel::KernelModel;
using kernel::KernelSums;

constexpr std::size_t kPiecesAtATime = 512;

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

// What a part's columns are of the scene's, by the chain rule: what it takes for the strength of a
// light, of ambient light or of a lobe is that strength times a colour and a factor. After the
// scene's columns come, where the factors are unknowns, those of its keyframe.
Eigen::MatrixXd MapOf(const model::Scene& scene, const model::Parameters& parameters,
                      const Part& part, const KernelModel& model) {
  const bool all = part.channel == kAll;
  const int albedos = model.channels, lights = parameters.lights();
  const int factors = scene.free_factors ? lights : 0;
  Eigen::MatrixXd map =
      Eigen::MatrixXd::Zero(albedos + model.Shared(), parameters.count() + factors);
  for (int c = 0; c < albedos; ++c) map(c, parameters.Albedo(all ? c : part.channel)) = 1.0;
  const auto row = [&](int column) { return albedos + column - parameters.channels(); };
  for (int i = 0; i < model.Shared(); ++i) map(albedos + i, parameters.channels() + i) = 1.0;
  const auto colour = [&](const Eigen::Vector3d& of) { return all ? 1.0 : of[part.channel]; };
  for (int l = 0; l < lights; ++l) {
    const model::Light& light = scene.lights[static_cast<std::size_t>(l)];
    const int at = row(parameters.Intensity(l));
    const double factor = part.keyframe == kAll || light.factors.empty()
                              ? 1.0
                              : light.factors[static_cast<std::size_t>(part.keyframe)];
    map(at, parameters.Intensity(l)) = colour(light.color) * factor;
    if (const int column = all ? -1 : parameters.Colour(l, part.channel); column >= 0)
      map(at, column) = light.intensity * factor;
    if (factors > 0) map(at, parameters.count() + l) = colour(light.color) * light.intensity;
  }
  if (all) return map;
  const model::Reflectance& r = scene.reflectance;
  const auto ambient = [&](int column, double strength) {
    map(row(column), column) = r.ambient_colour[part.channel];
    if (const int by = parameters.AmbientColour(part.channel); by >= 0)
      map(row(column), by) = strength;
  };
  ambient(parameters.Ambient(), r.ambient);
  for (int j = 0; parameters.Harmonic(0) >= 0 && j < model::kHarmonics; ++j)
    ambient(parameters.Harmonic(j), r.harmonics[j]);
  for (int k = 0; k < parameters.lobes(); ++k) {
    const int strength = parameters.Strength(k);
    map(row(strength), strength) = r.specular_colour[part.channel];
    if (const int by = parameters.SpecularColour(part.channel); by >= 0)
      map(row(strength), by) = r.lobes[static_cast<std::size_t>(k)].strength;
  }
  return map;
}

bool IsWhole(const Part& part) { return part.channel == kAll && part.keyframe == kAll; }

void AddTo(NormalEquations& sum, NormalEquations part) {
  if (sum.gradient.size() == 0) {
    sum = std::move(part);
    return;
  }
  sum.hessian += part.hessian;
  sum.gradient += part.gradient;
  sum.cost += part.cost;
}

// Of each part, by the columns of the scene and its keyframe's factors.
template <typename Real, typename Function>
std::vector<NormalEquations> EvaluateParts(const observe::Observations& observations,
                                           const model::Scene& scene,
                                           const EvaluateOptions& options,
                                           const KernelScenes& scenes, Function accumulate) {
  std::vector<ChunkSums> sums;
  std::size_t first = 0;
  const auto accumulate_piece = [&](std::size_t i) {
    const KernelScenes::Piece& piece = scenes.pieces[first + i];
    const KernelModel& model = scenes.scenes[piece.part].model;
    std::vector<Real> workspace(kernel::WorkspaceSize(model.Shared()));
    std::vector<const std::uint8_t*> lit;
    accumulate(model,
               PixelsOf(observations, options, piece.first, piece.tiles,
                        scenes.parts[piece.part].channel, lit),
               workspace.data(), sums[i].sums);
  };
  const model::Parameters parameters(scene, observations.channels);
  std::vector<NormalEquations> out;
  std::size_t piece = 0;
  for (std::size_t p = 0; p < scenes.parts.size(); ++p) {
    const KernelModel& model = scenes.scenes[p].model;
    ChunkSums total(model.Shared());
    for (; piece < scenes.pieces.size() && scenes.pieces[piece].part == p; ++piece) {
      if (piece == first + sums.size()) {
        // The sums of many pieces are large: so many at a time.
        first = piece;
        sums.clear();
        for (std::size_t i = first; i < std::min(first + kPiecesAtATime, scenes.pieces.size()); ++i)
          sums.emplace_back(scenes.scenes[scenes.pieces[i].part].model.Shared());
        ParallelFor(sums.size(), accumulate_piece);
      }
      total.Add(sums[piece - first], model.channels);
    }
    NormalEquations& part = out.emplace_back(Assemble(model, total.sums));
    if (IsWhole(scenes.parts[p])) continue;
    const Eigen::MatrixXd map = MapOf(scene, parameters, scenes.parts[p], model);
    part.hessian = map.transpose() * part.hessian * map;
    part.gradient = map.transpose() * part.gradient;
  }
  return out;
}

// What is known of the departures from the diffuse model beforehand: that they are small.
void AddPrices(const model::Scene& scene, int channels, const EvaluateOptions& options,
               NormalEquations& sum) {
  if (!(options.shading_price > 0.0)) return;
  const model::Parameters parameters(scene, channels);
  for (int j = 0; j < model::kHarmonics; ++j) {
    const int column = parameters.Shading(j);
    const double value = scene.reflectance.shading[j];
    sum.cost += 0.5 * options.shading_price * value * value;
    if (column < 0) continue;
    sum.gradient[column] += options.shading_price * value;
    sum.hessian(column, column) += options.shading_price;
  }
}

template <typename Real, typename Function>
NormalEquations EvaluateWith(const observe::Observations& observations, const model::Scene& scene,
                             EvaluateOptions options, Function accumulate) {
  // To eliminate factors takes the matrices.
  if (scene.free_factors && !options.factors) options.gradient_only = false;
  const KernelScenes scenes(observations, scene, options);
  auto parts = EvaluateParts<Real>(observations, scene, options, scenes, accumulate);
  NormalEquations sum;
  if (!scene.free_factors) {
    for (NormalEquations& part : parts) AddTo(sum, std::move(part));
    AddPrices(scene, observations.channels, options, sum);
    return sum;
  }
  std::vector<NormalEquations> keyframes(observations.tile_begin.size() - 1);
  for (std::size_t p = 0; p < parts.size(); ++p)
    AddTo(keyframes[static_cast<std::size_t>(scenes.parts[p].keyframe)], std::move(parts[p]));
  const int shared = model::Parameters(scene, observations.channels).count();
  sum.factors = options.factors
                    ? options.factors
                    : std::make_shared<const FrameFactors>(EliminateFactors(keyframes, shared));
  for (std::size_t k = 0; k < keyframes.size(); ++k) AddReduced(*sum.factors, k, keyframes[k], sum);
  AddPrices(scene, observations.channels, options, sum);
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
  const KernelScenes scenes(observations, scene, gradient_only);
  const model::Parameters parameters(scene, observations.channels);
  Eigen::MatrixXd out =
      Eigen::MatrixXd::Zero(parameters.count(), static_cast<Eigen::Index>(observations.tiles()));
  for (std::size_t p = 0; p < scenes.parts.size(); ++p) {
    const Part& part = scenes.parts[p];
    const KernelModel& model = scenes.scenes[p].model;
    Eigen::MatrixXd map;
    if (!IsWhole(part)) map = MapOf(scene, parameters, part, model);
    if (scene.free_factors)
      map = map * options.factors->Substitution(static_cast<std::size_t>(part.keyframe));
    ParallelFor(part.tiles, [&](std::size_t i) {
      std::vector<float> workspace(kernel::WorkspaceSize(model.Shared()));
      std::vector<const std::uint8_t*> lit;
      ChunkSums sums(model.Shared());
      kernel::BestKernel().accumulate(
          model, PixelsOf(observations, options, part.first + i, 1, part.channel, lit),
          workspace.data(), sums.sums);
      const Eigen::VectorXd gradient = Assemble(model, sums.sums).gradient;
      const auto at = static_cast<Eigen::Index>(part.first + i);
      if (IsWhole(part))
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
