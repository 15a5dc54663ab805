// The reflectance models of the kernel, with their derivatives. Included by the kernel's variants
// only (see lanes.h).
#pragma once

#include "estimator/solve/kernel/pixel_block.h"

namespace turnlight::estimator::solve::kernel {
namespace {

// A reflectance term f of the unit direction l towards a light, with its gradient by l (not
// projected on the sphere) and its derivatives by the model's own parameters and by the parallax
// within the pixel.
template <typename Real>
struct Term {
  typename Lanes<Real>::V value, by_parameter;
  Vector3<Real> gradient;
  typename Lanes<Real>::V by_parallax;
};

template <typename Real>
TURNLIGHT_INLINE Term<Real> Diffuse(const KernelModel& model, const Block<Real>& block,
                                    const Vector3<Real>& l, typename Lanes<Real>::V nl) {
  using L = Lanes<Real>;
  using V = typename L::V;
  const V zero = L::Splat(0.0);
  if (!model.oren_nayar) return {nl, zero, block.normal, zero};
  const V a = L::Splat(model.oren_nayar_a), b = L::Splat(model.oren_nayar_b);
  const V nv = block.viewer_cosine;
  const V projected = l.Dot(block.viewer) - nl * nv;
  const V larger = L::Max(L::Max(nl, nv), L::Splat(1e-6));
  const V s = L::Max(projected, zero) / larger;
  const V ds_dprojected = projected > zero ? Real(1) / larger : zero;
  const V ds_dlarger = nl > nv ? -s / larger : zero;
  Term<Real> term;
  term.value = nl * (a + b * s);
  term.by_parameter = nl * (L::Splat(model.oren_nayar_da) + L::Splat(model.oren_nayar_db) * s);
  const V by_nl = a + b * s + b * nl * (ds_dlarger - nv * ds_dprojected);
  term.gradient = block.normal * by_nl + block.viewer * (b * nl * ds_dprojected);
  return term;
}

// What the lobe is measured against at one point of the footprint: w for Phong, the normal for
// Blinn-Phong; and, for Phong, by how much the parallax moves it for each unit.
template <typename Real>
struct SampledAxis {
  Vector3<Real> axis, step;
};

// At node (i, j) of samples x samples, samples > 1.
template <typename Real>
TURNLIGHT_INLINE SampledAxis<Real> SampleAxis(const KernelModel& model, const Block<Real>& block,
                                              typename Lanes<Real>::V parallax, int samples, int i,
                                              int j) {
  using L = Lanes<Real>;
  using V = typename L::V;
  const V zero = L::Splat(0.0);
  const bool phong = model.specular_model == Specular::kPhong;
  Vector3<Real> step{zero, zero, zero};
  const V du = L::Splat(model.node[samples][i]), dv = L::Splat(model.node[samples][j]);
  Vector3<Real> axis = block.mirrored + block.dw_du * du + block.dw_dv * dv;
  if (phong) {
    step = block.dx_du * du + block.dx_dv * dv;
    axis = axis + step * parallax;
  }
  const V norm = axis.InverseNorm();
  axis = axis * norm;
  step = step * norm;
  if (!phong) {
    axis = axis + block.viewer;
    axis = axis * (Real(1) / L::Sqrt(L::Max(axis.Dot(axis), L::Splat(1e-12))));
  }
  return {axis, step};
}

// The specular term, its mean over samples x samples points of the pixel's footprint. The footprint
// moves the mirrored ray w; for Blinn-Phong the normal is the one that mirrors the view into it. It
// also moves the point itself, and so the direction of a near light the other way, by `parallax`
// (inverse distance over |L|) times the step: for Phong that is as if w moved on by as much.
template <typename Real>
TURNLIGHT_INLINE Term<Real> SpecularMean(const KernelModel& model, const Block<Real>& block,
                                         const Vector3<Real>& l, typename Lanes<Real>::V parallax,
                                         int samples) {
  using L = Lanes<Real>;
  using V = typename L::V;
  const V zero = L::Splat(0.0), n = L::Splat(model.shininess);
  Term<Real> mean{zero, zero, {zero, zero, zero}, zero};
  const bool phong = model.specular_model == Specular::kPhong;
  V inverse_half_norm = zero;
  Vector3<Real> half = l;
  if (!phong) {
    half = l + block.viewer;
    inverse_half_norm = Real(1) / L::Sqrt(L::Max(half.Dot(half), L::Splat(1e-12)));
    half = half * inverse_half_norm;
  }
  for (int j = 0; j < samples; ++j) {
    for (int i = 0; i < samples; ++i) {
      SampledAxis<Real> at{phong ? block.mirrored : block.normal, {zero, zero, zero}};
      if (samples > 1) at = SampleAxis(model, block, parallax, samples, i, j);
      const Vector3<Real>&axis = at.axis, &step = at.step;
      const Vector3<Real> chord = half - axis;
      const V c = Real(0.5) * chord.Dot(chord);
      const V t = L::Max(Real(1) - c, L::Splat(1e-6));
      const V logarithm = LogOneMinus(L::Min(c, L::Splat(1.0 - 1e-6)));
      const V weight = L::Splat(model.weight[samples][i] * model.weight[samples][j]);
      const V power = Real(1) - c > zero ? weight * ExpNegative(n * logarithm) : zero;
      mean.value += power;
      mean.by_parameter += power * logarithm;
      const V slope = n * power / t;
      mean.gradient =
          mean.gradient + (phong ? axis * slope : (axis - half * t) * (slope * inverse_half_norm));
      if (samples > 1)
        mean.by_parallax += slope * (half.Dot(step) - half.Dot(axis) * axis.Dot(step));
    }
  }
  return mean;
}

// Whether the lobe reaches any pixel of the block: beyond exp(-40) it is exactly zero. Two samples
// a side are for footprints of at most half the lobe's half-width (FootprintSamples), by which
// exp(-60) at the centre is beyond exp(-40) at all of them.
template <typename Real>
TURNLIGHT_INLINE bool LobeReaches(const KernelModel& model, const Block<Real>& block,
                                  const Vector3<Real>& l, int samples) {
  if (samples > 2 || model.specular_model != Specular::kPhong) return true;
  using L = Lanes<Real>;
  // log(1 - c) <= -c, so n c > 40 is beyond reach.
  const double beyond = samples == 1 ? 40.0 : 60.0;
  const Vector3<Real> chord = l - block.mirrored;
  const auto c = Real(0.5) * chord.Dot(chord);
  return L::Any(L::Splat(model.shininess) * c < L::Splat(beyond));
}

}  // namespace
}  // namespace turnlight::estimator::solve::kernel
