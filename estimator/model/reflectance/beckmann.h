// Torrance and Sparrow, "Theory for Off-Specular Reflection from Roughened Surfaces" (JOSA 1967),
// with Beckmann's distribution of slopes: f_s = D F G / (4 n.v), the factor n.l of the irradiance
// being in it. D = exp(-tan^2 / a^2) / (pi a^2 cos^4) of the angle between n and h; F is Schlick's;
// G = G1(n.l) G1(n.v) is Smith's shadowing and masking in the rational form of Walter, Marschner,
// Li, Torrance, "Microfacet Models for Refraction through Rough Surfaces" (EGSR 2007), eq. 27. Its
// shape is a, the root mean square slope times the square root of 2.
#pragma once

#include <cmath>
#include <numbers>

#include "estimator/model/reflectance/fresnel.h"

namespace turnlight::estimator::model::reflectance {

struct Beckmann {
  static constexpr LobeFacts kFacts{
      "beckmann", "Torrance-Sparrow (Beckmann)", "alpha", 0.003, 1.5, false, true, false};

  // G1(x) / x of the cosine x, and its derivatives by x and by a. With b = x / (a sqrt(1 - x^2)) G1
  // is (3.535 b + 2.181 b^2) / (1 + 2.276 b + 2.577 b^2), and 1 from b = 1.6 on (`open`).
  template <typename M>
  struct Masking {
    typename M::V value, by_cosine, by_shape;
  };
  template <typename M>
  static Masking<M> Mask(double shape, typename M::V x) {
    using V = typename M::V;
    const V one = M::Splat(1.0), zero = M::Splat(0.0);
    const V sine_squared = M::Max(one - x * x, M::Splat(1e-8));
    const V k = one / (M::Splat(shape) * M::Sqrt(sine_squared));  // b = x k
    const V b = x * k;
    const V p = M::Splat(3.535) + M::Splat(2.181) * b;
    const V q = one + M::Splat(2.276) * b + M::Splat(2.577) * b * b;
    const V rational = k * p / q;
    // Of p / q by b, and of k and b by x and a: k' = k x / (1 - x^2), b' = k / (1 - x^2).
    const V by_b = (M::Splat(2.181) - p * (M::Splat(2.276) + M::Splat(5.154) * b) / q) / q;
    const V by_cosine = (k * x * p / q + k * k * by_b) / sine_squared;
    const V by_shape = -(rational + k * b * by_b) / M::Splat(shape);
    const auto open = b > M::Splat(1.6);
    const V inverse = one / x;
    return {open ? inverse : rational, open ? -inverse * inverse : by_cosine,
            open ? zero : by_shape};
  }

  template <typename M>
  static LobeTerm<M> Evaluate(double shape, double f0, const LobeArguments<M>& at) {
    using V = typename M::V;
    const V zero = M::Splat(0.0), one = M::Splat(1.0), two = M::Splat(2.0);
    const V c = M::Min(at.below_one, M::Splat(1.0 - 1e-4));
    const V cosine = one - c, squared = cosine * cosine;
    const V tan_squared = c * (two - c) / squared;
    const V inverse = M::Splat(1.0 / (shape * shape));
    const V slopes = M::Splat(0.25 / (std::numbers::pi * shape * shape)) *
                     M::ExpNegative(-tan_squared * inverse) / (squared * squared);
    // G / (4 n.v) is n.l (G1(n.l) / n.l) (G1(n.v) / n.v) / 4; the quarter is in `slopes`.
    const V nl = M::Max(at.light_cosine, M::Splat(1e-6));
    const V nv = M::Max(at.view_cosine, M::Splat(1e-3));
    const Masking<M> light = Mask<M>(shape, nl), view = Mask<M>(shape, nv);
    const FresnelTerm<M> fresnel = SchlickFresnel<M>(f0, at.half_cosine);
    const V masks = nl * light.value * view.value;
    const V common = at.weight * slopes * masks;
    LobeTerm<M> out;
    out.value = common * fresnel.value;
    // d log D by the cosine: 2 / (a^2 cos^3) - 4 / cos.
    out.by_cosine = out.value * (two * inverse / squared - M::Splat(4.0)) / cosine;
    const V unmasked = at.weight * slopes * fresnel.value;
    out.by_light_cosine = unmasked * view.value * (light.value + nl * light.by_cosine);
    out.by_half_cosine = common * fresnel.by_cosine;
    out.by_shape = out.value * two * (tan_squared * inverse - one) / M::Splat(shape) +
                   unmasked * nl * (light.by_shape * view.value + light.value * view.by_shape);
    out.by_f0 = common * fresnel.by_f0;
    const auto faces = at.light_cosine > zero;
    out.by_light_cosine = faces ? out.by_light_cosine : zero;
    return out;
  }
  static double InverseVariance(double shape) { return 2.0 / (shape * shape); }
  static double ShapeOf(double inverse_variance) { return std::sqrt(2.0 / inverse_variance); }
  // tan^2 = a^2 log 2, cos^4 left out: it matters where the lobe is as wide as the hemisphere.
  static double HalfWidth(double shape) { return std::atan(shape * std::sqrt(std::numbers::ln2)); }
};

}  // namespace turnlight::estimator::model::reflectance
