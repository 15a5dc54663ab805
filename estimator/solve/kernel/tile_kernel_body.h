// The tile kernel itself, in any precision. Included by its variants only (see lanes.h).
#pragma once

#include "estimator/solve/kernel/shading.h"

namespace turnlight::estimator::solve::kernel {
namespace {

// A light as a block sees it.
template <typename Real>
struct LightAt {
  const KernelLight& light;
  Vector3<Real> l;                                     // unit
  typename Lanes<Real>::V falloff, inverse, parallax;  // a_l, 1 / |L|, rho / |L|

  // The direction in which parameter k of a light's place moves L: two tangents, the distance.
  TURNLIGHT_INLINE Vector3<Real> Along(const Block<Real>& block, int k) const {
    return k < 2 ? SplatVector<Real>(light.tangent[k]) : block.position * Lanes<Real>::Splat(-1.0);
  }
};

// The diffuse rows of one light: its intensity, two tangents, and inverse distance.
template <typename Real>
TURNLIGHT_INLINE void StoreDiffuseRows(const KernelModel& model, const Block<Real>& block, int row,
                                       const LightAt<Real>& at, const DiffuseTerm<Real>& diffuse,
                                       const Rows<Real>& rows, int offset) {
  using L = Lanes<Real>;
  using V = typename L::V;
  const V intensity = L::Splat(at.light.intensity), kd = L::Splat(model.diffuse);
  L::Store(rows.A(row) + offset, kd * at.falloff * diffuse.value);
  // f(l) / |L|^2 by L along e: (g.e - (g.l + 2 f)(l.e)) / |L|^3
  const V cube = at.falloff * at.inverse * intensity;
  const V by_l = diffuse.gradient.Dot(at.l) + Real(2) * diffuse.value;
  for (int k = 0; k < 3; ++k) {
    const Vector3<Real> e = at.Along(block, k);
    L::Store(rows.A(row + 1 + k) + offset,
             kd * cube * (diffuse.gradient.Dot(e) - by_l * at.l.Dot(e)));
  }
}

// The same of a lobe. add: to those of the lobes before.
template <typename Real>
TURNLIGHT_INLINE void StoreLobeRows(double strength, bool add, const Block<Real>& block, int row,
                                    const LightAt<Real>& at, const LobeMean<Real>& lobe, bool shiny,
                                    const Rows<Real>& rows, int offset) {
  using L = Lanes<Real>;
  using V = typename L::V;
  const V zero = L::Splat(0.0), intensity = L::Splat(at.light.intensity), ks = L::Splat(strength);
  const auto store = [&](int i, V value) TURNLIGHT_LAMBDA {
    Real* to = rows.B(i) + offset;
    L::Store(to, add ? L::Load(to) + value : value);
  };
  store(row, ks * at.falloff * lobe.value);
  const V cube = at.falloff * at.inverse * intensity;
  const V by_l = lobe.gradient.Dot(at.l) + Real(2) * lobe.value;
  for (int k = 0; k < 3; ++k) {
    const Vector3<Real> e = at.Along(block, k);
    const V le = at.l.Dot(e);
    // How the parallax within the pixel changes: rho itself, and the distance.
    const V changed = (k < 2 ? zero : at.inverse) - at.parallax * at.inverse * le;
    const V by_parallax = at.falloff * intensity * lobe.by_parallax * changed;
    store(row + 1 + k,
          shiny ? ks * (cube * (lobe.gradient.Dot(e) - by_l * le) + by_parallax) : zero);
  }
}

template <typename Real, bool kJacobian>
TURNLIGHT_INLINE Shading<Real> ShadeBlock(const KernelModel& model, const Block<Real>& block,
                                          int samples, const Rows<Real>& rows, int offset) {
  using L = Lanes<Real>;
  using V = typename L::V;
  const V zero = L::Splat(0.0);
  Shading<Real> sum{zero, zero, zero, {zero, zero}, {zero, zero}, {zero, zero}, zero, {}, zero};
  ShadeAmbient(model, block, sum);
  for (int index = 0; index < model.lights; ++index) {
    const KernelLight& light = model.light[index];
    const V rho = L::Splat(light.inverse_distance), intensity = L::Splat(light.intensity);
    const Vector3<Real> to_light = SplatVector<Real>(light.direction) - block.position * rho;
    const V inverse = to_light.InverseNorm();
    const Vector3<Real> l = to_light * inverse;
    const V nl = block.normal.Dot(l);
    V falloff = nl > zero ? inverse * inverse * block.valid : zero;
    if (block.lit) falloff *= LoadBytes<Real>(block.lit[index] + block.at);
    const LightAt<Real> at{light, l, falloff, inverse, rho * inverse};
    const int row = model.first_light_row + kPerLight * index;
    DiffuseTerm<Real> diffuse = Diffuse(model, block, l, nl);
    if (model.shades) {
      sum.plain += intensity * falloff * diffuse.value;
      diffuse = {diffuse.value * sum.departure, diffuse.by_shape * sum.departure,
                 diffuse.gradient * sum.departure};
    }
    sum.diffuse += intensity * falloff * diffuse.value;
    sum.by_roughness += intensity * falloff * diffuse.by_shape;
    if constexpr (kJacobian) StoreDiffuseRows(model, block, row, at, diffuse, rows, offset);
    for (int k = 0; k < model.lobes; ++k) {
      const KernelLobe& lobe = model.lobe[k];
      LobeMean<Real> mean{zero, zero, zero, {zero, zero, zero}, zero};
      bool shiny = false;
      reflectance::Lobes::Visit(lobe.number, [&](auto of) TURNLIGHT_LAMBDA {
        shiny = MeanOf<decltype(of)>(model, lobe, block, l, at.parallax, samples, mean);
      });
      sum.specular[k] += intensity * falloff * mean.value;
      sum.by_shape[k] += intensity * falloff * mean.by_shape;
      sum.by_f0[k] += intensity * falloff * mean.by_f0;
      if constexpr (kJacobian)
        StoreLobeRows(lobe.strength, k > 0, block, row, at, mean, shiny, rows, offset);
    }
  }
  return sum;
}

// The white part of a block's radiance: that of the lobes.
template <typename Real>
TURNLIGHT_INLINE typename Lanes<Real>::V White(const KernelModel& model,
                                               const Shading<Real>& shading) {
  using L = Lanes<Real>;
  auto sum = L::Splat(0.0);
  if (model.lobes > 0) sum = L::Splat(model.lobe[0].strength) * shading.specular[0];
  for (int k = 1; k < model.lobes; ++k)
    sum += L::Splat(model.lobe[k].strength) * shading.specular[k];
  return sum;
}

template <typename Real>
struct WeighedResidual {
  typename Lanes<Real>::V weight, cost;
};

// Huber's loss on the pixel's root-mean-square residual, and the weight of its rows. square: the
// sum of its channels' squared residuals, each times the pixel's own weight.
template <typename Real>
TURNLIGHT_INLINE WeighedResidual<Real> WeighResidual(const KernelModel& model,
                                                     const Block<Real>& block,
                                                     typename Lanes<Real>::V square) {
  using L = Lanes<Real>;
  using V = typename L::V;
  V weight = block.weight, cost = Real(0.5) * square;
  if (model.huber > 0.0) {
    const V scale = L::Splat(model.huber), channels = L::Splat(model.channels);
    const V size = L::Sqrt(L::Max(square / channels, L::Splat(1e-30)));
    const auto far = size > scale;
    weight = far ? L::Sqrt(scale / size) * block.weight : weight;
    cost = far ? channels * (scale * size - Real(0.5) * scale * scale) * block.valid : cost;
  }
  return {weight, cost};
}

// The rows of the parameters that all lights share, weighted.
template <typename Real>
TURNLIGHT_INLINE void StoreSharedRows(const KernelModel& model, const Shading<Real>& shading,
                                      typename Lanes<Real>::V weight, const Rows<Real>& rows,
                                      int offset) {
  using L = Lanes<Real>;
  using V = typename L::V;
  const V zero = L::Splat(0.0), one = L::Splat(1.0);
  V a[kMostBeforeLights], b[kMostBeforeLights];
  for (int i = 0; i < model.first_light_row; ++i) a[i] = b[i] = zero;
  a[model.ambient_row] = one;
  for (int j = 0; model.harmonics && model.harmonics_row >= 0 && j < kHarmonics; ++j)
    a[model.harmonics_row + j] = shading.harmonic[j];
  for (int j = 0; model.shades && model.shading_row >= 0 && j < kHarmonics; ++j)
    a[model.shading_row + j] = L::Splat(model.diffuse) * shading.plain * shading.harmonic[j];
  a[model.diffuse_row] = shading.diffuse;
  a[model.roughness_row] = L::Splat(model.diffuse) * shading.by_roughness;
  for (int k = 0; k < model.lobes; ++k) {
    const KernelLobe& lobe = model.lobe[k];
    b[lobe.strength_row] = shading.specular[k];
    // By the logarithm of the shape.
    b[lobe.shape_row] = L::Splat(lobe.strength * lobe.shape) * shading.by_shape[k];
    if (lobe.f0_row >= 0) b[lobe.f0_row] = L::Splat(lobe.strength) * shading.by_f0[k];
  }
  for (int i = 0; i < model.first_light_row; ++i) {
    L::Store(rows.A(i) + offset, a[i] * weight);
    L::Store(rows.B(i) + offset, b[i] * weight);
  }
}

// Residuals of a block, its shared rows and their weights. Returns its cost.
template <typename Real>
TURNLIGHT_INLINE typename Lanes<Real>::V FinishBlock(const KernelModel& model, Block<Real> block,
                                                     const Shading<Real>& shading,
                                                     const Rows<Real>& rows, int offset) {
  using L = Lanes<Real>;
  using V = typename L::V;
  const V zero = L::Splat(0.0);
  const V albedo_row = shading.ambient + L::Splat(model.diffuse) * shading.diffuse;
  const V white = White(model, shading);
  if (block.one_sided) {
    // At white and the model above it: nothing is wrong.
    V above = zero;
    for (int c = 0; c < model.channels; ++c)
      above += L::Splat(model.albedo[c]) * albedo_row + white - block.radiance[c];
    const auto satisfied = (block.at_white > zero) & (above > zero);
    block.valid = satisfied ? zero : block.valid;
    block.weight = satisfied ? zero : block.weight;
  }
  V residual[3], square = zero, residual_a = zero, residual_b = zero;
  for (int c = 0; c < model.channels; ++c) {
    residual[c] =
        (L::Splat(model.albedo[c]) * albedo_row + white - block.radiance[c]) * block.valid;
    const V weighted = model.weighted ? residual[c] * block.weight : residual[c];
    square += weighted * weighted;
  }
  const auto [weight, cost] = WeighResidual(model, block, square);
  for (int c = 0; c < model.channels; ++c) {
    residual[c] *= weight;
    residual_a += L::Splat(model.albedo[c]) * residual[c];
    residual_b += residual[c];
    L::Store(rows.Residual(c) + offset, residual[c]);
  }
  L::Store(rows.Albedo() + offset, albedo_row * weight);
  L::Store(rows.ResidualA() + offset, residual_a);
  L::Store(rows.ResidualB() + offset, residual_b);
  StoreSharedRows(model, shading, weight, rows, offset);
  if (model.huber > 0.0 || model.weighted || block.one_sided) {
    for (int i = model.first_light_row; i < rows.shared; ++i) {
      L::Store(rows.A(i) + offset, L::Load(rows.A(i) + offset) * weight);
      L::Store(rows.B(i) + offset, L::Load(rows.B(i) + offset) * weight);
    }
  }
  return cost;
}

// Lane sums of a run of tiles, in the kernel's precision, before they are flushed to double.
// Order: blocks of pairs, then per i: gradient, albedo a, albedo b, then E^2, E r_c.
template <typename Real>
TURNLIGHT_INLINE void AddDot(Real* sum, const Real* x, const Real* y) {
  using L = Lanes<Real>;
  typename L::V total = L::Load(sum);
  for (int i = 0; i < kTilePixels; i += kLanes) total += L::Load(x + i) * L::Load(y + i);
  L::Store(sum, total);
}

// Rows are multiplied in blocks of 4 x 4, so that each load serves four products. How many lanes
// and columns of a block fit into its registers is a variant's own; the sums are not.
#ifndef TURNLIGHT_DOT_LANES
#define TURNLIGHT_DOT_LANES 4
#define TURNLIGHT_DOT_COLUMNS 2
#endif
constexpr int kBlock = 4;
constexpr int kBlockSums = kBlock * kBlock * kLanes;

template <typename Real>
TURNLIGHT_INLINE void AddBlock(Real* sums, const Real* x, const Real* y) {
  constexpr int kSub = TURNLIGHT_DOT_LANES, kColumns = TURNLIGHT_DOT_COLUMNS;
  typedef Real S __attribute__((vector_size(kSub * sizeof(Real))));
  const auto load = [](const Real* from) {
    S v;
    std::memcpy(&v, from, sizeof v);
    return v;
  };
  for (int lane = 0; lane < kLanes; lane += kSub)
    for (int column = 0; column < kBlock; column += kColumns) {
      S total[kBlock][kColumns];
      Real* at = sums + column * kLanes + lane;
      for (int i = 0; i < kBlock; ++i)
        for (int j = 0; j < kColumns; ++j) total[i][j] = load(at + (i * kBlock + j) * kLanes);
      for (int p = lane; p < kTilePixels; p += kLanes) {
        S xs[kBlock];
        for (int i = 0; i < kBlock; ++i) xs[i] = load(x + i * kTilePixels + p);
        for (int j = 0; j < kColumns; ++j) {
          const S ys = load(y + (column + j) * kTilePixels + p);
          for (int i = 0; i < kBlock; ++i) total[i][j] += xs[i] * ys;
        }
      }
      for (int i = 0; i < kBlock; ++i)
        for (int j = 0; j < kColumns; ++j)
          std::memcpy(at + (i * kBlock + j) * kLanes, &total[i][j], sizeof(S));
    }
}

template <typename Real>
TURNLIGHT_INLINE void AddTile(const KernelModel& model, const Rows<Real>& rows, Real* sums) {
  using L = Lanes<Real>;
  const int n = rows.shared;
  const bool specular = model.lobes > 0;
  Real* linear = sums + PairSums(n);
  for (int i = 0; i < n; ++i) {
    AddDot(linear + (3 * i) * kLanes, rows.A(i), rows.ResidualA());
    if (specular) AddDot(linear + (3 * i) * kLanes, rows.B(i), rows.ResidualB());
    if (model.gradient_only) continue;
    AddDot(linear + (3 * i + 1) * kLanes, rows.A(i), rows.Albedo());
    if (specular) AddDot(linear + (3 * i + 2) * kLanes, rows.B(i), rows.Albedo());
  }
  Real* rest = linear + 3 * n * kLanes;
  AddDot(rest, rows.Albedo(), rows.Albedo());
  for (int c = 0; c < model.channels; ++c)
    AddDot(rest + (1 + c) * kLanes, rows.Albedo(), rows.Residual(c));
  if (model.gradient_only) return;
  // Rows to pseudo-channels in place, then their products.
  const auto l11 = L::Splat(model.l11), l21 = L::Splat(model.l21), l22 = L::Splat(model.l22);
  for (int i = 0; i < n; ++i)
    for (int p = 0; p < kTilePixels; p += kLanes) {
      const auto a = L::Load(rows.A(i) + p);
      if (!specular) {
        L::Store(rows.A(i) + p, l11 * a);
        continue;
      }
      const auto b = L::Load(rows.B(i) + p);
      L::Store(rows.A(i) + p, l11 * a + l21 * b);
      L::Store(rows.B(i) + p, l22 * b);
    }
  Real* block = sums;
  for (int i = 0; i < n; i += kBlock)
    for (int j = i; j < n; j += kBlock, block += kBlockSums) {
      AddBlock(block, rows.A(i), rows.A(j));
      if (specular && model.l22 > 0.0) AddBlock(block, rows.B(i), rows.B(j));
    }
}

template <typename Real>
TURNLIGHT_INLINE double FlushLane(Real* lanes) {
  double sum = 0.0;
  for (int i = 0; i < kLanes; ++i) {
    sum += static_cast<double>(lanes[i]);
    lanes[i] = Real(0);
  }
  return sum;
}

template <typename Real>
TURNLIGHT_INLINE void Flush(const KernelModel& model, int n, Real* sums, KernelSums& out) {
  Real* at = sums;
  for (int bi = 0; bi < n; bi += kBlock)
    for (int bj = bi; bj < n; bj += kBlock)
      for (int i = bi; i < bi + kBlock; ++i)
        for (int j = bj; j < bj + kBlock; ++j, at += kLanes) {
          const double sum = FlushLane(at);
          if (i <= j && j < n) out.shared[i * n + j] += sum;
        }
  for (int i = 0; i < n; ++i, at += 3 * kLanes) {
    out.gradient[i] += FlushLane(at);
    out.albedo_a[i] += FlushLane(at + kLanes);
    out.albedo_b[i] += FlushLane(at + 2 * kLanes);
  }
  out.albedo_square += FlushLane(at);
  for (int c = 0; c < model.channels; ++c)
    out.albedo_gradient[c] += FlushLane(at + (1 + c) * kLanes);
}

template <typename Real>
TURNLIGHT_INLINE void AccumulateTiles(const KernelModel& model, const KernelPixels& pixels,
                                      Real* workspace, KernelSums& out) {
  using L = Lanes<Real>;
  constexpr std::size_t kTilesPerFlush = 8;
  const int n = model.Shared();
  const Rows<Real> rows{workspace, n};
  Real* sums = rows.Sums();
  // Also the rows that only fill up the last block.
  std::memset(workspace, 0, sizeof(Real) * WorkspaceSize(n));
  for (std::size_t tile = 0; tile < pixels.tiles; ++tile) {
    const int samples = pixels.samples ? pixels.samples[tile] : 1;
    for (int offset = 0; offset < kTilePixels; offset += kLanes) {
      const auto block = LoadBlock<Real>(
          model, pixels, tile * kTilePixels + static_cast<std::size_t>(offset), samples);
      const auto shading = ShadeBlock<Real, true>(model, block, samples, rows, offset);
      const auto cost = FinishBlock<Real>(model, block, shading, rows, offset);
      Real lanes[kLanes];
      L::Store(lanes, cost);
      out.cost += FlushLane(lanes);
    }
    AddTile(model, rows, sums);
    if ((tile + 1) % kTilesPerFlush == 0 || tile + 1 == pixels.tiles) Flush(model, n, sums, out);
  }
}

template <typename Real>
TURNLIGHT_INLINE void PredictTiles(const KernelModel& model, const KernelPixels& pixels,
                                   Real* workspace, Real* const* out) {
  using L = Lanes<Real>;
  const Rows<Real> rows{workspace, model.Shared()};
  for (std::size_t tile = 0; tile < pixels.tiles; ++tile) {
    const int samples = pixels.samples ? pixels.samples[tile] : 1;
    for (int offset = 0; offset < kTilePixels; offset += kLanes) {
      const std::size_t at = tile * kTilePixels + static_cast<std::size_t>(offset);
      const auto block = LoadBlock<Real>(model, pixels, at, samples);
      const auto shading = ShadeBlock<Real, false>(model, block, samples, rows, offset);
      const auto diffuse = shading.ambient + L::Splat(model.diffuse) * shading.diffuse;
      const auto white = White(model, shading);
      for (int c = 0; c < model.channels; ++c)
        L::Store(out[c] + at, L::Splat(model.albedo[c]) * diffuse + white);
    }
  }
}

}  // namespace
}  // namespace turnlight::estimator::solve::kernel
