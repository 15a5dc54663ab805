// What one light adds to a block: the diffuse term and the lobes', these averaged over the pixels'
// footprints, with their derivatives. Included by the kernel's variants only (see lanes.h).
#pragma once

#include "estimator/model/reflectance/models.h"
#include "estimator/model/spherical_harmonics.h"
#include "estimator/solve/kernel/pixel_block.h"

namespace turnlight::estimator::solve::kernel {
namespace {

namespace reflectance = model::reflectance;

// The diffuse term, with its gradient by the unit direction l (not projected on the sphere).
template <typename Real>
struct DiffuseTerm {
  typename Lanes<Real>::V value, by_shape;
  Vector3<Real> gradient;
};

template <typename Real>
TURNLIGHT_INLINE DiffuseTerm<Real> Diffuse(const KernelModel& model, const Block<Real>& block,
                                           const Vector3<Real>& l, typename Lanes<Real>::V nl) {
  using L = Lanes<Real>;
  DiffuseTerm<Real> out;
  reflectance::DiffuseModels::Visit(model.diffuse_model, [&](auto diffuse) TURNLIGHT_LAMBDA {
    using Model = decltype(diffuse);
    reflectance::DiffuseArguments<L> at{nl, block.viewer_cosine, L::Splat(0.0)};
    if constexpr (Model::kAlongView) at.projected = l.Dot(block.viewer) - nl * at.view_cosine;
    const auto term = Model::template Evaluate<L>(model.diffuse_constants, at);
    out = {term.value, term.by_shape, block.normal * term.along_normal};
    if constexpr (Model::kAlongView) out.gradient = out.gradient + block.viewer * term.along_view;
  });
  return out;
}

// A lobe's term, its mean over a footprint, with its gradient by l and its derivative by the
// parallax within the pixel.
template <typename Real>
struct LobeMean {
  typename Lanes<Real>::V value, by_shape, by_f0;
  Vector3<Real> gradient;
  typename Lanes<Real>::V by_parallax;
};

// What the lobe is measured against at one point of the footprint: the mirrored view or the normal;
// and, for the mirrored view, by how much the parallax moves it for each unit.
template <typename Real>
struct SampledAxis {
  Vector3<Real> axis, step;
};

// At node (i, j) of samples x samples, samples > 1.
template <bool kMirrored, typename Real>
TURNLIGHT_INLINE SampledAxis<Real> SampleAxis(const KernelModel& model, const Block<Real>& block,
                                              typename Lanes<Real>::V parallax, int samples, int i,
                                              int j) {
  using L = Lanes<Real>;
  using V = typename L::V;
  const V zero = L::Splat(0.0);
  Vector3<Real> step{zero, zero, zero};
  const V du = L::Splat(model.node[samples][i]), dv = L::Splat(model.node[samples][j]);
  Vector3<Real> axis = block.mirrored + block.dw_du * du + block.dw_dv * dv;
  if constexpr (kMirrored) {
    step = block.dx_du * du + block.dx_dv * dv;
    axis = axis + step * parallax;
  }
  const V norm = axis.InverseNorm();
  axis = axis * norm;
  step = step * norm;
  if constexpr (!kMirrored) {
    axis = axis + block.viewer;
    axis = axis * (Real(1) / L::Sqrt(L::Max(axis.Dot(axis), L::Splat(1e-12))));
  }
  return {axis, step};
}

// Whether a lobe cos^n reaches any pixel of the block: beyond exp(-40) it is exactly zero. Two
// samples a side are for footprints of at most half the lobe's half-width (FootprintSamples), by
// which exp(-60) at the centre is beyond exp(-40) at all of them.
template <typename Real>
TURNLIGHT_INLINE bool PowerReaches(double exponent, const Vector3<Real>& axis,
                                   const Vector3<Real>& half, int samples) {
  if (samples > 2) return true;
  using L = Lanes<Real>;
  // log(1 - c) <= -c, so n c > 40 is beyond reach.
  const double beyond = samples == 1 ? 40.0 : 60.0;
  const Vector3<Real> chord = half - axis;
  const auto c = Real(0.5) * chord.Dot(chord);
  return L::Any(L::Splat(exponent) * c < L::Splat(beyond));
}

// Adds a point's term. half: what the axis is compared with; inverse_half_norm: 1 / |l + v| of a
// half vector.
template <typename Lobe, typename Real>
TURNLIGHT_INLINE void AddSample(const Block<Real>& block,
                                const reflectance::LobeArguments<Lanes<Real>>& at,
                                const reflectance::LobeTerm<Lanes<Real>>& term,
                                const Vector3<Real>& half,
                                typename Lanes<Real>::V inverse_half_norm,
                                const SampledAxis<Real>& sample, int samples,
                                LobeMean<Real>& mean) {
  using L = Lanes<Real>;
  const Vector3<Real>&axis = sample.axis, &step = sample.step;
  mean.value += term.value;
  mean.by_shape += term.by_shape;
  if constexpr (Lobe::kFacts.about_mirrored_view) {
    mean.gradient = mean.gradient + axis * term.by_cosine;
    if (samples > 1)
      mean.by_parallax += term.by_cosine * (half.Dot(step) - half.Dot(axis) * axis.Dot(step));
  } else {
    const auto cosine = L::Max(Real(1) - at.below_one, L::Splat(1e-6));
    mean.gradient = mean.gradient + (axis - half * cosine) * (term.by_cosine * inverse_half_norm);
  }
  if constexpr (Lobe::kFacts.physical) {
    mean.by_f0 += term.by_f0;
    mean.gradient =
        mean.gradient + axis * term.by_light_cosine +
        (block.viewer - half * at.half_cosine) * (term.by_half_cosine * inverse_half_norm);
  }
}

// The mean over samples x samples points of the pixel's footprint; false where it is 0 and so is
// all else. The footprint moves the mirrored ray w; for a lobe about the normal that is the one
// that mirrors the view into it. It also moves the point itself, and so the direction of a near
// light the other way, by `parallax` (inverse distance over |L|) times the step: for a lobe about
// the mirrored view that is as if w moved on by as much.
template <typename Lobe, typename Real>
TURNLIGHT_INLINE bool MeanOf(const KernelModel& model, const KernelLobe& lobe,
                             const Block<Real>& block, const Vector3<Real>& l,
                             typename Lanes<Real>::V parallax, int samples, LobeMean<Real>& mean) {
  using L = Lanes<Real>;
  using V = typename L::V;
  constexpr bool kMirrored = Lobe::kFacts.about_mirrored_view;
  const V zero = L::Splat(0.0);
  V inverse_half_norm = zero;
  Vector3<Real> half = l;
  if constexpr (!kMirrored) {
    half = l + block.viewer;
    inverse_half_norm = Real(1) / L::Sqrt(L::Max(half.Dot(half), L::Splat(1e-12)));
    half = half * inverse_half_norm;
  }
  const Vector3<Real>& centre = kMirrored ? block.mirrored : block.normal;
  if (Lobe::kFacts.cosine_power && !PowerReaches(lobe.shape, centre, half, samples)) return false;
  reflectance::LobeArguments<L> at{zero, zero, zero, zero, zero};
  if constexpr (Lobe::kFacts.physical) at.half_cosine = block.viewer.Dot(half);
  for (int j = 0; j < samples; ++j) {
    for (int i = 0; i < samples; ++i) {
      SampledAxis<Real> sample{centre, {zero, zero, zero}};
      if (samples > 1) sample = SampleAxis<kMirrored>(model, block, parallax, samples, i, j);
      const Vector3<Real>& axis = sample.axis;
      const Vector3<Real> chord = half - axis;
      at.below_one = Real(0.5) * chord.Dot(chord);
      at.weight = L::Splat(model.weight[samples][i] * model.weight[samples][j]);
      if constexpr (Lobe::kFacts.physical) {
        at.light_cosine = axis.Dot(l);
        at.view_cosine = axis.Dot(block.viewer);
      }
      const auto term = Lobe::template Evaluate<L>(lobe.shape, lobe.f0, at);
      AddSample<Lobe>(block, at, term, half, inverse_half_norm, sample, samples, mean);
    }
  }
  return true;
}

}  // namespace
}  // namespace turnlight::estimator::solve::kernel
