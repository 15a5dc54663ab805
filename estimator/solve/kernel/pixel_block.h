// Sixteen pixels as the kernel takes them, and where it writes their rows. Included by the kernel's
// variants only (see lanes.h).
#pragma once

#include "estimator/solve/kernel/lanes.h"

namespace turnlight::estimator::solve::kernel {
namespace {

// One block of sixteen pixels.
template <typename Real>
struct Block {
  using V = typename Lanes<Real>::V;
  Vector3<Real> position, normal, mirrored, viewer, dw_du, dw_dv, dx_du, dx_dv;
  V viewer_cosine;
  V radiance[3];
  V valid;     // 1, or 0 for filling and what is left out
  V weight;    // of the residuals; as valid where the pixels are not weighted
  V at_white;  // 1 where the residual is one-sided
  bool one_sided;
  const std::uint8_t* const* lit;
  std::size_t at;
};

template <typename Real>
TURNLIGHT_INLINE Vector3<Real> LoadVector(const float* const* from, std::size_t at) {
  return {LoadFloats(from[0] + at, Real{}), LoadFloats(from[1] + at, Real{}),
          LoadFloats(from[2] + at, Real{})};
}

template <typename Real>
TURNLIGHT_INLINE Block<Real> LoadBlock(const KernelModel& model, const KernelPixels& pixels,
                                       std::size_t at, int samples) {
  Block<Real> block;
  block.position = LoadVector<Real>(pixels.position, at);
  block.normal = LoadVector<Real>(pixels.normal, at);
  block.mirrored = LoadVector<Real>(pixels.mirrored, at);
  block.viewer_cosine = block.normal.Dot(block.mirrored);
  block.viewer = block.normal * (Real(2) * block.viewer_cosine) - block.mirrored;
  for (int c = 0; c < model.channels; ++c)
    block.radiance[c] = LoadFloats(pixels.radiance[c] + at, Real{});
  for (int i = 0; i < kLanes; ++i)
    block.valid[i] = pixels.pixel[at + static_cast<std::size_t>(i)] == kNoPixel ? Real(0) : Real(1);
  if (pixels.usable) block.valid *= LoadBytes<Real>(pixels.usable + at);
  block.weight = block.valid;
  if (pixels.weight) block.weight *= LoadFloats(pixels.weight + at, Real{});
  block.one_sided = pixels.at_white != nullptr;
  for (int i = 0; block.one_sided && i < kLanes; ++i)
    block.at_white[i] = (pixels.at_white[at + static_cast<std::size_t>(i)] & model.white_bits) != 0
                            ? Real(1)
                            : Real(0);
  block.lit = pixels.lit;
  block.at = at;
  if (samples > 1) {
    const auto f = [&](int k) { return LoadBFloat16<Real>(pixels.footprint[k] + at); };
    block.dw_du = {f(0), f(1), f(2)};
    block.dw_dv = {f(3), f(4), f(5)};
    const auto g = [&](int k) { return LoadBFloat16<Real>(pixels.step[k] + at); };
    block.dx_du = {g(0), g(1), g(2)};
    block.dx_dv = {g(3), g(4), g(5)};
  }
  return block;
}

// Rows of a tile. Each row has kTilePixels scalars: a_i and b_i of the shared parameters (each set
// filled up with zeros to whole blocks), E, p, q, r_c.
template <typename Real>
struct Rows {
  Real* base;
  int shared;
  TURNLIGHT_INLINE Real* A(int i) const {
    return base + static_cast<std::ptrdiff_t>(i) * kTilePixels;
  }
  TURNLIGHT_INLINE Real* B(int i) const { return A(PaddedRows(shared) + i); }
  TURNLIGHT_INLINE Real* Albedo() const { return A(2 * PaddedRows(shared)); }
  TURNLIGHT_INLINE Real* ResidualA() const { return A(2 * PaddedRows(shared) + 1); }
  TURNLIGHT_INLINE Real* ResidualB() const { return A(2 * PaddedRows(shared) + 2); }
  TURNLIGHT_INLINE Real* Residual(int c) const { return A(2 * PaddedRows(shared) + 3 + c); }
  TURNLIGHT_INLINE Real* Sums() const { return A(2 * PaddedRows(shared) + kExtraRows); }
};

}  // namespace
}  // namespace turnlight::estimator::solve::kernel
