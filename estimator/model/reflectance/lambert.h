// Lambert, "Photometria" (1760): f_d = n.l. The factor 1/pi is left out.
#pragma once

#include "estimator/model/reflectance/terms.h"

namespace turnlight::estimator::model::reflectance {

struct Lambert {
  static constexpr DiffuseFacts kFacts{"lambert", "Lambert", false};
  static constexpr bool kAlongView = false;

  static void FillConstants(double /*shape*/, double* /*constants*/) {}
  template <typename M>
  static DiffuseTerms<M> Evaluate(const double* /*constants*/, const DiffuseArguments<M>& at) {
    const typename M::V zero = M::Splat(0.0);
    return {at.light_cosine, zero, M::Splat(1.0), zero};
  }
};

}  // namespace turnlight::estimator::model::reflectance
