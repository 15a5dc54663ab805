#include "estimator/solve/kernel_scene.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "estimator/model/parameters.h"
#include "estimator/model/reflectance/models.h"
#include "estimator/model/tangent_basis.h"

namespace turnlight::estimator::solve {
namespace {

using kernel::KernelModel;
using kernel::KernelPixels;

static_assert(kernel::kNoPixel == observe::Observations::kNoPixel, "filled up with the same");
static_assert(kernel::kMostLobes == model::kMostLobes, "as many lobes");
static_assert(kernel::kHarmonics == model::kHarmonics, "as many harmonics");
static_assert(kernel::kDiffuseConstants == model::reflectance::kDiffuseConstants, "as many");
static_assert(kernel::kTilePixels == observe::kTile,
              "a tile of observations is a tile of the kernel");

// A unit of parallel work: 16 384 pixels, less where that would leave threads idle. A function of
// the number of tiles alone.
constexpr std::size_t kMostTilesPerChunk = 64, kFewestTilesPerChunk = 4, kChunksWanted = 16;

// Legendre's P_n(x) and its derivative, by the three-term recurrence.
std::pair<double, double> Legendre(int n, double x) {
  double previous = 1.0, value = x;
  for (int k = 2; k <= n; ++k) {
    const double next = ((2 * k - 1) * x * value - (k - 1) * previous) / k;
    previous = value;
    value = next;
  }
  return {value, n * (x * value - previous) / (x * x - 1.0)};
}

// Nodes and weights on [-1/2, 1/2] for every number of samples.
struct Quadrature {
  double node[kernel::kMaxSamples + 1][kernel::kMaxSamples];
  double weight[kernel::kMaxSamples + 1][kernel::kMaxSamples];
};

Quadrature MakeQuadrature() {
  Quadrature out{};
  for (int n = 1; n <= kernel::kMaxSamples; ++n) {
    for (int i = 0; i < n; ++i) {
      double x = -std::cos(std::numbers::pi * (i + 0.75) / (n + 0.5));
      for (int step = 0; n > 1 && step < 20; ++step) {
        const auto [value, slope] = Legendre(n, x);
        x -= value / slope;
      }
      const double slope = Legendre(n, x).second;
      out.node[n][i] = n == 1 ? 0.0 : 0.5 * x;
      out.weight[n][i] = n == 1 ? 1.0 : 1.0 / ((1.0 - x * x) * slope * slope);
    }
  }
  return out;
}

void FillQuadrature(double aperture, KernelModel& model) {
  static const Quadrature kQuadrature = MakeQuadrature();
  for (int n = 0; n <= kernel::kMaxSamples; ++n)
    for (int i = 0; i < kernel::kMaxSamples; ++i)
      model.node[n][i] = aperture * kQuadrature.node[n][i];
  std::memcpy(model.weight, kQuadrature.weight, sizeof model.weight);
}

void FillReflectance(const model::Reflectance& r, const model::Parameters& parameters,
                     KernelModel& model) {
  // The kernel's rows are the columns after the albedo's.
  const auto row = [&](int column) { return column < 0 ? -1 : column - parameters.channels(); };
  model.ambient = r.ambient;
  model.diffuse = r.diffuse;
  model.diffuse_model = static_cast<int>(r.diffuse_model);
  model::reflectance::DiffuseModels::Visit(model.diffuse_model, [&](auto diffuse) {
    decltype(diffuse)::FillConstants(r.roughness, model.diffuse_constants);
  });
  model.harmonics = parameters.Harmonic(0) >= 0 || !r.harmonics.isZero(0.0);
  for (int j = 0; j < kernel::kHarmonics; ++j) model.harmonic[j] = r.harmonics[j];
  model.ambient_row = row(parameters.Ambient());
  model.harmonics_row = row(parameters.Harmonic(0));
  model.shades = parameters.Shading(0) >= 0 || !r.shading.isZero(0.0);
  for (int j = 0; j < kernel::kHarmonics; ++j) model.shading[j] = r.shading[j];
  model.shading_row = row(parameters.Shading(0));
  model.diffuse_row = row(parameters.Diffuse());
  model.roughness_row = row(parameters.Roughness());
  model.first_light_row = parameters.FirstLight() - parameters.channels();
  model.lobes = r.lobes[0].present() ? parameters.lobes() : 0;
  for (int k = 0; k < model.lobes; ++k) {
    const model::Lobe& lobe = r.lobes[static_cast<std::size_t>(k)];
    model.lobe[k] = {static_cast<int>(lobe.model) - 1,
                     lobe.strength,
                     lobe.shape,
                     lobe.f0,
                     row(parameters.Strength(k)),
                     row(parameters.Shape(k)),
                     row(parameters.F0(k))};
  }
}

}  // namespace

KernelScene::KernelScene(const observe::Observations& observations, const model::Scene& scene,
                         const EvaluateOptions& options, const Part& part) {
  const int channel = part.channel;
  const bool all = channel == kAll;
  for (const model::Light& light : scene.lights) {
    const Eigen::Matrix<double, 3, 2> basis = model::TangentBasis(light.direction);
    kernel::KernelLight& out = lights.emplace_back();
    for (int k = 0; k < 3; ++k) {
      out.direction[k] = light.direction[k];
      out.tangent[0][k] = basis(k, 0);
      out.tangent[1][k] = basis(k, 1);
    }
    out.inverse_distance = light.inverse_distance;
    out.intensity = all ? light.intensity : light.intensity * light.color[channel];
    if (part.keyframe != kAll && !light.factors.empty())
      out.intensity *= light.factors[static_cast<std::size_t>(part.keyframe)];
  }
  const model::Reflectance& r = scene.reflectance;
  model.channels = all ? observations.channels : 1;
  model.lights = static_cast<int>(lights.size());
  model.light = lights.data();
  double sum = 0.0, square = 0.0;
  for (int c = 0; c < model.channels; ++c) {
    const double albedo = r.albedo[all ? c : channel];
    model.albedo[c] = albedo;
    sum += albedo;
    square += albedo * albedo;
  }
  FillReflectance(r, model::Parameters(scene, model.channels), model);
  if (!all) {
    model.ambient *= r.ambient_colour[channel];
    for (double& harmonic : model.harmonic) harmonic *= r.ambient_colour[channel];
    for (int k = 0; k < model.lobes; ++k) model.lobe[k].strength *= r.specular_colour[channel];
  }
  model.huber = options.huber;
  model.weighted = !observations.weight.empty();
  model.white_bits = all ? observe::kAtWhite : 1 << channel;
  model.gradient_only = options.gradient_only;
  FillQuadrature(options.aperture, model);
  model.l11 = std::sqrt(std::max(square, 1e-30));
  model.l21 = sum / model.l11;
  const double rest = model.channels - model.l21 * model.l21;
  model.l22 = rest > 1e-12 ? std::sqrt(rest) : 0.0;
}

std::vector<Part> PartsOf(const model::Scene& scene, const observe::Observations& observations) {
  const bool by_channel = (scene.free_colours || scene.coloured()) && observations.channels > 1;
  const bool by_keyframe = scene.free_factors || scene.flickers();
  const int keyframes = by_keyframe ? static_cast<int>(observations.tile_begin.size()) - 1 : 1;
  std::vector<Part> parts;
  for (int k = 0; k < keyframes; ++k)
    for (int c = 0; c < (by_channel ? observations.channels : 1); ++c) {
      Part& part = parts.emplace_back(Part{by_channel ? c : kAll, kAll, 0, observations.tiles()});
      if (!by_keyframe) continue;
      const auto at = static_cast<std::size_t>(k);
      part.keyframe = k;
      part.first = observations.tile_begin[at];
      part.tiles = observations.tile_begin[at + 1] - part.first;
    }
  return parts;
}

KernelScenes::KernelScenes(const observe::Observations& observations, const model::Scene& scene,
                           const EvaluateOptions& options)
    : parts(PartsOf(scene, observations)) {
  for (std::size_t p = 0; p < parts.size(); ++p) {
    scenes.emplace_back(observations, scene, options, parts[p]);
    const Chunks chunks(parts[p].tiles);
    for (std::size_t i = 0; i < chunks.count(); ++i)
      pieces.push_back({p, parts[p].first + chunks.First(i), chunks.Tiles(i)});
  }
}

// One chunk's arrays. lit: room for a pointer for each light.
KernelPixels PixelsOf(const observe::Observations& all, const EvaluateOptions& options,
                      std::size_t tile, std::size_t tiles, int channel,
                      std::vector<const std::uint8_t*>& lit) {
  KernelPixels pixels{};
  const std::size_t at = tile * observe::kTile;
  const Shadows& shadows = options.shadows;
  for (const PixelMask& mask : shadows.lit) lit.push_back(mask->data() + at);
  pixels.lit = shadows.lit.empty() ? nullptr : lit.data();
  pixels.usable = shadows.usable ? shadows.usable->data() + at : nullptr;
  for (int k = 0; k < 3; ++k) {
    pixels.position[k] = all.position[k].data() + at;
    pixels.normal[k] = all.normal[k].data() + at;
    pixels.mirrored[k] = all.mirrored[k].data() + at;
    pixels.radiance[k] = k < all.channels ? all.radiance[k].data() + at : nullptr;
  }
  if (channel != kAll) pixels.radiance[0] = pixels.radiance[channel];
  for (int k = 0; k < 6; ++k) {
    pixels.footprint[k] = all.footprint[k].data() + at;
    pixels.step[k] = all.step[k].data() + at;
  }
  pixels.pixel = all.pixel.data() + at;
  pixels.weight = all.weight.empty() ? nullptr : all.weight.data() + at;
  pixels.at_white = all.at_white.empty() ? nullptr : all.at_white.data() + at;
  pixels.samples =
      options.samples_per_side.empty() ? nullptr : options.samples_per_side.data() + tile;
  pixels.tiles = tiles;
  return pixels;
}

Chunks::Chunks(std::size_t all_tiles)
    : tiles(all_tiles),
      per_chunk(std::clamp(all_tiles / kChunksWanted, kFewestTilesPerChunk, kMostTilesPerChunk)) {}

std::size_t Chunks::Tiles(std::size_t chunk) const {
  return std::min(per_chunk, tiles - First(chunk));
}

}  // namespace turnlight::estimator::solve
