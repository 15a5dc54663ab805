// Lambert's surface under a smooth dielectric coat: light is refracted on its way in and out, f_d =
// n.l T(n.l) T(n.v) with T(c) = (1 - F(c)) / (1 - F0) = 1 - (1 - c)^5 after Schlick, whatever F0
// is. As the diffuse part of Ashikhmin and Shirley, "An Anisotropic Phong BRDF Model" (JGT 2000),
// but with whole angles; factors that depend on no direction are left out.
#pragma once

#include "estimator/model/reflectance/fresnel.h"

namespace turnlight::estimator::model::reflectance {

struct Coated {
  static constexpr DiffuseFacts kFacts{"coated", "Lambert under a coat", false};
  static constexpr bool kAlongView = false;

  static void FillConstants(double /*shape*/, double* /*constants*/) {}
  template <typename M>
  static DiffuseTerms<M> Evaluate(const double* /*constants*/, const DiffuseArguments<M>& at) {
    using V = typename M::V;
    // With F0 = 0 Schlick's F is (1 - c)^5, and by_f0 = 1 - (1 - c)^5 is T.
    const FresnelTerm<M> in = SchlickFresnel<M>(0.0, at.light_cosine);
    const FresnelTerm<M> out = SchlickFresnel<M>(0.0, at.view_cosine);
    const V zero = M::Splat(0.0);
    const V& through = out.by_f0;  // T(n.v)
    return {at.light_cosine * in.by_f0 * through, zero,
            (in.by_f0 - at.light_cosine * in.by_cosine) * through, zero};
  }
};

}  // namespace turnlight::estimator::model::reflectance
