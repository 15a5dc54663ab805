// GGX (Trowbridge and Reitz, JOSA 1975; Walter, Marschner, Li, Torrance, "Microfacet Models for
// Refraction through Rough Surfaces", EGSR 2007, eq. 33 and 34): f_s = D F G / (4 n.v), the factor
// n.l of the irradiance being in it. D = a^2 / (pi (cos^2 (a^2 - 1) + 1)^2) of the angle between n
// and h; F is Schlick's; G = G1(n.l) G1(n.v) is Smith's shadowing and masking, G1(x) = 2 x / (x +
// sqrt(a^2 + (1 - a^2) x^2)). Its shape is a.
#pragma once

#include <cmath>
#include <numbers>

#include "estimator/model/reflectance/fresnel.h"

namespace turnlight::estimator::model::reflectance {

struct Ggx {
  static constexpr LobeFacts kFacts{"ggx", "GGX", "alpha", 0.003, 1.0, false, true, false};

  template <typename M>
  static LobeTerm<M> Evaluate(double shape, double f0, const LobeArguments<M>& at) {
    using V = typename M::V;
    const V zero = M::Splat(0.0), one = M::Splat(1.0), two = M::Splat(2.0);
    const double a2 = shape * shape;
    const V squared = M::Splat(a2), rest = M::Splat(1.0 - a2), a = M::Splat(shape);
    const V c = M::Min(at.below_one, one);
    const V sine_squared = c * (two - c);
    const V t = squared + rest * sine_squared;
    const V slopes = M::Splat(a2 / std::numbers::pi) / (t * t);
    const V nl = M::Max(at.light_cosine, zero), nv = M::Max(at.view_cosine, zero);
    const V root_l = M::Sqrt(squared + rest * nl * nl), root_v = M::Sqrt(squared + rest * nv * nv);
    // G / (4 n.v) = n.l / ((n.l + root_l) (n.v + root_v)), the roots being those of G1.
    const V sum_l = nl + root_l, sum_v = nv + root_v;
    const FresnelTerm<M> fresnel = SchlickFresnel<M>(f0, at.half_cosine);
    const V common = at.weight * slopes * nl / (sum_l * sum_v);
    LobeTerm<M> out;
    out.value = common * fresnel.value;
    out.by_cosine = out.value * M::Splat(4.0) * rest * (one - c) / t;
    const V unmasked = at.weight * slopes * fresnel.value / (sum_l * sum_v);
    const auto faces = at.light_cosine > zero;
    out.by_light_cosine = faces ? unmasked * (one - nl * (one + rest * nl / root_l) / sum_l) : zero;
    out.by_half_cosine = common * fresnel.by_cosine;
    // The roots' relative changes by a.
    const V by_roots =
        a * (one - nl * nl) / (root_l * sum_l) + a * (one - nv * nv) / (root_v * sum_v);
    out.by_shape = out.value * (two / a - M::Splat(4.0) * a * (one - sine_squared) / t - by_roots);
    out.by_f0 = common * fresnel.by_f0;
    return out;
  }
  static double InverseVariance(double shape) { return 2.0 / (shape * shape); }
  static double ShapeOf(double inverse_variance) { return std::sqrt(2.0 / inverse_variance); }
  // D is half of its peak where sin^2 (1 - a^2) = a^2 (sqrt 2 - 1).
  static double HalfWidth(double shape) {
    const double rest = 1.0 - shape * shape, sine = shape * std::sqrt(std::numbers::sqrt2 - 1.0);
    return sine * sine < rest ? std::asin(sine / std::sqrt(rest)) : std::numbers::pi / 2.0;
  }
};

}  // namespace turnlight::estimator::model::reflectance
