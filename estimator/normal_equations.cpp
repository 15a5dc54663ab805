#include "estimator/normal_equations.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "base/parallel.h"
#include "estimator/kernel/tile_kernel.h"

namespace turnlight::estimator {
namespace {

using kernel::KernelModel;
using kernel::KernelPixels;
using kernel::KernelSums;

// A unit of parallel work: 16 384 pixels, less where that would leave threads idle. A function of
// the number of tiles alone.
constexpr std::size_t kMostTilesPerChunk = 64, kFewestTilesPerChunk = 4, kChunksWanted = 16;

std::size_t TilesPerChunk(std::size_t tiles) {
  return std::clamp(tiles / kChunksWanted, kFewestTilesPerChunk, kMostTilesPerChunk);
}

kernel::Specular KernelSpecular(SpecularModel model) {
  switch (model) {
    case SpecularModel::kNone:
      return kernel::Specular::kNone;
    case SpecularModel::kPhong:
      return kernel::Specular::kPhong;
    case SpecularModel::kBlinnPhong:
      return kernel::Specular::kBlinnPhong;
  }
  return kernel::Specular::kNone;
}

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

void FillOrenNayar(KernelModel& model, const Reflectance& reflectance) {
  const double s = reflectance.roughness, v = s * s;
  model.oren_nayar = reflectance.diffuse_model == DiffuseModel::kOrenNayar;
  model.oren_nayar_a = 1.0 - 0.5 * v / (v + 0.33);
  model.oren_nayar_b = 0.45 * v / (v + 0.09);
  model.oren_nayar_da = -0.5 * 0.33 / ((v + 0.33) * (v + 0.33));
  model.oren_nayar_db = 0.45 * 0.09 / ((v + 0.09) * (v + 0.09));
}

// A model in the kernel's form; the lights live beside it.
struct KernelScene {
  KernelModel model{};
  std::vector<kernel::KernelLight> lights;

  KernelScene(const Observations& observations, const Scene& scene,
              const EvaluateOptions& options) {
    for (const Light& light : scene.lights) {
      const Eigen::Matrix<double, 3, 2> basis = TangentBasis(light.direction);
      kernel::KernelLight& out = lights.emplace_back();
      for (int k = 0; k < 3; ++k) {
        out.direction[k] = light.direction[k];
        out.tangent[0][k] = basis(k, 0);
        out.tangent[1][k] = basis(k, 1);
      }
      out.inverse_distance = light.inverse_distance;
      out.intensity = light.intensity;
    }
    const Reflectance& r = scene.reflectance;
    model.channels = observations.channels;
    model.lights = static_cast<int>(lights.size());
    model.light = lights.data();
    double sum = 0.0, square = 0.0;
    for (int c = 0; c < model.channels; ++c) {
      model.albedo[c] = r.albedo[c];
      sum += r.albedo[c];
      square += r.albedo[c] * r.albedo[c];
    }
    model.ambient = r.ambient;
    model.diffuse = r.diffuse;
    model.specular = r.specular;
    model.shininess = r.shininess;
    model.specular_model = KernelSpecular(r.specular_model);
    model.huber = options.huber;
    model.gradient_only = options.gradient_only;
    FillOrenNayar(model, r);
    FillQuadrature(options.aperture, model);
    model.l11 = std::sqrt(std::max(square, 1e-30));
    model.l21 = sum / model.l11;
    const double rest = model.channels - model.l21 * model.l21;
    model.l22 = rest > 1e-12 ? std::sqrt(rest) : 0.0;
  }
  KernelScene(const KernelScene&) = delete;
  KernelScene& operator=(const KernelScene&) = delete;
};

// One chunk's arrays. lit: room for a pointer for each light.
KernelPixels PixelsOf(const Observations& all, const EvaluateOptions& options, std::size_t tile,
                      std::size_t tiles, std::vector<const std::uint8_t*>& lit) {
  KernelPixels pixels{};
  const std::size_t at = tile * kTile;
  const Shadows& shadows = options.shadows;
  for (const Plane& plane : shadows.lit) lit.push_back(plane->data() + at);
  pixels.lit = shadows.lit.empty() ? nullptr : lit.data();
  pixels.usable = shadows.usable ? shadows.usable->data() + at : nullptr;
  for (int k = 0; k < 3; ++k) {
    pixels.position[k] = all.position[k].data() + at;
    pixels.normal[k] = all.normal[k].data() + at;
    pixels.mirrored[k] = all.mirrored[k].data() + at;
    pixels.radiance[k] = k < all.channels ? all.radiance[k].data() + at : nullptr;
  }
  for (int k = 0; k < 6; ++k) {
    pixels.footprint[k] = all.footprint[k].data() + at;
    pixels.step[k] = all.step[k].data() + at;
  }
  pixels.pixel = all.pixel.data() + at;
  pixels.samples =
      options.samples_per_side.empty() ? nullptr : options.samples_per_side.data() + tile;
  pixels.tiles = tiles;
  return pixels;
}

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

template <typename Real, typename Function>
NormalEquations EvaluateWith(const Observations& observations, const Scene& scene,
                             const EvaluateOptions& options, Function accumulate) {
  const KernelScene kernel_scene(observations, scene, options);
  const int n = kernel_scene.model.Shared();
  const std::size_t per_chunk = TilesPerChunk(observations.tiles());
  const std::size_t chunks = (observations.tiles() + per_chunk - 1) / per_chunk;
  std::vector<ChunkSums> parts;
  parts.reserve(chunks);
  for (std::size_t i = 0; i < chunks; ++i) parts.emplace_back(n);
  ParallelFor(chunks, [&](std::size_t chunk) {
    const std::size_t first = chunk * per_chunk;
    const std::size_t tiles = std::min(per_chunk, observations.tiles() - first);
    std::vector<Real> workspace(kernel::WorkspaceSize(n));
    std::vector<const std::uint8_t*> lit;
    accumulate(kernel_scene.model, PixelsOf(observations, options, first, tiles, lit),
               workspace.data(), parts[chunk].sums);
  });
  ChunkSums total(n);
  for (const ChunkSums& part : parts) total.Add(part, observations.channels);
  return Assemble(kernel_scene.model, total.sums);
}

}  // namespace

Eigen::Matrix<double, 3, 2> TangentBasis(const Eigen::Vector3d& u) {
  const double sign = std::copysign(1.0, u.z());
  const double a = -1.0 / (sign + u.z());
  const double b = u.x() * u.y() * a;
  Eigen::Matrix<double, 3, 2> basis;
  basis << 1.0 + sign * u.x() * u.x() * a, b,  //
      sign * b, sign + u.y() * u.y() * a,      //
      -sign * u.x(), -u.y();
  return basis;
}

NormalEquations Evaluate(const Observations& observations, const Scene& scene,
                         const EvaluateOptions& options) {
  return EvaluateWith<float>(observations, scene, options, kernel::BestKernel().accumulate);
}

Eigen::MatrixXd TileGradients(const Observations& observations, const Scene& scene,
                              const EvaluateOptions& options) {
  EvaluateOptions gradient_only = options;
  gradient_only.gradient_only = true;
  const KernelScene kernel_scene(observations, scene, gradient_only);
  const int n = kernel_scene.model.Shared();
  Eigen::MatrixXd out(observations.channels + n, static_cast<Eigen::Index>(observations.tiles()));
  ParallelFor(observations.tiles(), [&](std::size_t tile) {
    std::vector<float> workspace(kernel::WorkspaceSize(n));
    std::vector<const std::uint8_t*> lit;
    ChunkSums chunk(n);
    kernel::BestKernel().accumulate(kernel_scene.model,
                                    PixelsOf(observations, options, tile, 1, lit), workspace.data(),
                                    chunk.sums);
    out.col(static_cast<Eigen::Index>(tile)) = Assemble(kernel_scene.model, chunk.sums).gradient;
  });
  return out;
}

NormalEquations EvaluateDouble(const Observations& observations, const Scene& scene,
                               const EvaluateOptions& options) {
  return EvaluateWith<double>(observations, scene, options, kernel::AccumulateInDouble);
}

Prediction Predict(const Observations& observations, const Scene& scene,
                   const EvaluateOptions& options) {
  const KernelScene kernel_scene(observations, scene, options);
  Prediction out(static_cast<std::size_t>(observations.channels),
                 std::vector<float>(observations.size()));
  const std::size_t per_chunk = TilesPerChunk(observations.tiles());
  const std::size_t chunks = (observations.tiles() + per_chunk - 1) / per_chunk;
  ParallelFor(chunks, [&](std::size_t chunk) {
    const std::size_t first = chunk * per_chunk;
    const std::size_t tiles = std::min(per_chunk, observations.tiles() - first);
    std::vector<float> workspace(kernel::WorkspaceSize(kernel_scene.model.Shared()));
    float* channels[3] = {nullptr, nullptr, nullptr};
    for (std::size_t c = 0; c < out.size(); ++c) channels[c] = out[c].data() + first * kTile;
    std::vector<const std::uint8_t*> lit;
    kernel::BestKernel().predict(kernel_scene.model,
                                 PixelsOf(observations, options, first, tiles, lit),
                                 workspace.data(), channels);
  });
  return out;
}

double ValueCount(const Observations& observations, const EvaluateOptions& options) {
  return static_cast<double>(observations.used - options.shadows.left_out) * observations.channels;
}

double LobeHalfWidth(double shininess) { return std::acos(std::exp2(-1.0 / shininess)); }

std::vector<std::uint8_t> FootprintSamples(const Observations& observations, double shininess,
                                           int least) {
  const double half_width = LobeHalfWidth(shininess);
  std::vector<std::uint8_t> samples(observations.tiles());
  for (std::size_t tile = 0; tile < samples.size(); ++tile) {
    const double ratio = static_cast<double>(observations.tile_footprint[tile]) / half_width;
    // Below 0.2 the centre will do. Then as many Gauss points as keep the error of a Gaussian
    // lobe's mean below 1e-4 of its peak: 2 up to a ratio of 0.5, 3 up to 1.2, and on in
    // proportion.
    const int count = ratio < 0.2   ? least
                      : ratio < 0.5 ? 2
                                    : 2 + static_cast<int>(std::ceil(ratio / 1.2));
    samples[tile] = static_cast<std::uint8_t>(std::min(count, kernel::kMaxSamples));
  }
  return samples;
}

Scene ToSolver(const Scene& scene, const Observations& observations) {
  Scene out = scene;
  for (Light& light : out.lights) {
    light = Recentred(light, observations.reference);
    light.inverse_distance *= observations.radius;
  }
  return out;
}

Scene ToWorld(const Scene& scene, const Observations& observations) {
  Scene out = scene;
  for (Light& light : out.lights) {
    light.inverse_distance /= observations.radius;
    light = Recentred(light, -observations.reference);
  }
  return out;
}

}  // namespace turnlight::estimator
