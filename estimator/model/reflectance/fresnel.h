// Schlick, "An Inexpensive BRDF Model for Physically-based Rendering" (Eurographics 1994): the
// reflectance F0 + (1 - F0) (1 - c)^5 of a smooth face that is met under the cosine c.
#pragma once

#include "estimator/model/reflectance/terms.h"

namespace turnlight::estimator::model::reflectance {

template <typename M>
struct FresnelTerm {
  typename M::V value, by_f0, by_cosine;
};

template <typename M>
FresnelTerm<M> SchlickFresnel(double f0, typename M::V cosine) {
  using V = typename M::V;
  const V one = M::Splat(1.0), rest = M::Splat(1.0 - f0);
  const V below = M::Max(one - cosine, M::Splat(0.0));
  const V squared = below * below, fourth = squared * squared, fifth = fourth * below;
  return {M::Splat(f0) + rest * fifth, one - fifth, M::Splat(-5.0) * rest * fourth};
}

}  // namespace turnlight::estimator::model::reflectance
