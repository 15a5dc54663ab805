// What a block's lights add up to, and what depends on its normals alone. Included by the kernel's
// variants only (see lanes.h).
#pragma once

#include "estimator/solve/kernel/reflectance_terms.h"

namespace turnlight::estimator::solve::kernel {
namespace {

// What a block's lights add up to.
template <typename Real>
struct Shading {
  using V = typename Lanes<Real>::V;
  V diffuse, by_roughness;
  V plain;  // the diffuse sum as its model alone has it
  V specular[kMostLobes], by_shape[kMostLobes], by_f0[kMostLobes];
  V ambient;
  V harmonic[kHarmonics];  // their values, if the model has any
  V departure;             // what the diffuse model is multiplied by
};

// The ambient light of a block, and its departure from the diffuse model.
template <typename Real>
TURNLIGHT_INLINE void ShadeAmbient(const KernelModel& model, const Block<Real>& block,
                                   Shading<Real>& shading) {
  using L = Lanes<Real>;
  shading.ambient = L::Splat(model.ambient);
  if (!model.harmonics && !model.shades) return;
  model::FillHarmonics<L>(block.normal.x, block.normal.y, block.normal.z, shading.harmonic);
  for (int j = 0; model.harmonics && j < kHarmonics; ++j)
    shading.ambient += L::Splat(model.harmonic[j]) * shading.harmonic[j];
  if (!model.shades) return;
  shading.departure = L::Splat(1.0);
  for (int j = 0; j < kHarmonics; ++j)
    shading.departure += L::Splat(model.shading[j]) * shading.harmonic[j];
}

}  // namespace
}  // namespace turnlight::estimator::solve::kernel
