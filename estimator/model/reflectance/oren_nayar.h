// Oren and Nayar, "Generalization of Lambert's Reflectance Model" (SIGGRAPH 1994), the qualitative
// model: f_d = n.l (A + B max(0, cos of the azimuths' difference) sin(alpha) tan(beta)), alpha the
// larger angle and beta the smaller. The factor 1/pi is left out. Its shape is sigma, the root mean
// square slope of the facets in radians; its chart is sigma^2.
#pragma once

#include "estimator/model/reflectance/terms.h"

namespace turnlight::estimator::model::reflectance {

struct OrenNayar {
  static constexpr DiffuseFacts kFacts{"oren-nayar", "Oren-Nayar", true};
  static constexpr bool kAlongView = true;

  // A, B, and their derivatives by sigma^2.
  static void FillConstants(double shape, double* constants) {
    const double v = shape * shape;
    constants[0] = 1.0 - 0.5 * v / (v + 0.33);
    constants[1] = 0.45 * v / (v + 0.09);
    constants[2] = -0.5 * 0.33 / ((v + 0.33) * (v + 0.33));
    constants[3] = 0.45 * 0.09 / ((v + 0.09) * (v + 0.09));
  }
  // Without trigonometry: the azimuths' cosine times sin(alpha) sin(beta) is l.v - (n.l)(n.v), and
  // cos(beta), which makes a tangent of the second sine, is the larger of n.l and n.v.
  template <typename M>
  static DiffuseTerms<M> Evaluate(const double* constants, const DiffuseArguments<M>& at) {
    using V = typename M::V;
    const V zero = M::Splat(0.0), one = M::Splat(1.0);
    const V a = M::Splat(constants[0]), b = M::Splat(constants[1]);
    const V &nl = at.light_cosine, &nv = at.view_cosine;
    const V larger = M::Max(M::Max(nl, nv), M::Splat(1e-6));
    const V s = M::Max(at.projected, zero) / larger;
    const V by_projected = at.projected > zero ? one / larger : zero;
    const V by_larger = nl > nv ? -s / larger : zero;
    DiffuseTerms<M> out;
    out.value = nl * (a + b * s);
    out.by_shape = nl * (M::Splat(constants[2]) + M::Splat(constants[3]) * s);
    out.along_normal = a + b * s + b * nl * (by_larger - nv * by_projected);
    out.along_view = b * nl * by_projected;
    return out;
  }
};

}  // namespace turnlight::estimator::model::reflectance
