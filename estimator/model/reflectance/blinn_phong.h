// Blinn, "Models of Light Reflection for Computer Synthesized Pictures" (SIGGRAPH 1977): f_s =
// (n.h)^n, h halfway between light and viewer; not normalised, and without a factor n.l. Its shape
// is the exponent n.
#pragma once

#include "estimator/model/reflectance/phong.h"

namespace turnlight::estimator::model::reflectance {

struct BlinnPhong {
  static constexpr LobeFacts kFacts{"blinn-phong", "Blinn-Phong", "shininess", 0.5,
                                    1e5,           false,         false,       true};

  template <typename M>
  static LobeTerm<M> Evaluate(double shape, double /*f0*/, const LobeArguments<M>& at) {
    return CosinePower<M>(shape, at);
  }
  static double InverseVariance(double shape) { return shape; }
  static double ShapeOf(double inverse_variance) { return inverse_variance; }
  static double HalfWidth(double shape) { return Phong::HalfWidth(shape); }
};

}  // namespace turnlight::estimator::model::reflectance
