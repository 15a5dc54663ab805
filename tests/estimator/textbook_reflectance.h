// The reflectance models as their papers write them, with angles and dot products of any type of
// numbers (automatic derivatives too): an independent form of estimator/model/reflectance.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <numbers>

#include "estimator/model/scene.h"

namespace turnlight::estimator::textbook {

template <typename T>
using Vector = Eigen::Matrix<T, 3, 1>;

// Smith's masking: GGX's own, and Walter's rational form of Beckmann's.
template <typename T>
T Mask(model::SpecularModel model, const T& cosine, const T& alpha) {
  using std::sqrt;
  const T tangent = sqrt(1.0 - cosine * cosine) / cosine;
  if (model == model::SpecularModel::kGgx)
    return 2.0 / (1.0 + sqrt(1.0 + alpha * alpha * tangent * tangent));
  const T b = 1.0 / (alpha * tangent);
  if (!(b < T(1.6))) return T(1.0);
  return (3.535 * b + 2.181 * b * b) / (1.0 + 2.276 * b + 2.577 * b * b);
}

// f_s of a point that faces light and viewer.
template <typename T>
T Lobe(model::SpecularModel model, const T& shape, const T& f0, const Vector<T>& n,
       const Vector<T>& l, const Vector<T>& v) {
  using std::exp;
  using std::pow;
  using std::sqrt;
  if (model == model::SpecularModel::kNone) return T(0.0);
  if (model == model::SpecularModel::kPhong) {
    const T cosine = (n * (2.0 * n.dot(l)) - l).dot(v);
    return cosine > T(0.0) ? T(pow(cosine, shape)) : T(0.0);
  }
  const Vector<T> sum = l + v;
  const Vector<T> h = sum / sqrt(sum.dot(sum));
  const T cosine = n.dot(h);
  if (model == model::SpecularModel::kBlinnPhong)
    return cosine > T(0.0) ? T(pow(cosine, shape)) : T(0.0);
  const T squared = cosine * cosine, a2 = shape * shape;
  T slopes;
  if (model == model::SpecularModel::kGgx) {
    const T t = squared * (a2 - 1.0) + 1.0;
    slopes = a2 / (std::numbers::pi * t * t);
  } else {
    slopes = exp((1.0 - 1.0 / squared) / a2) / (std::numbers::pi * a2 * squared * squared);
  }
  const T fresnel = f0 + (1.0 - f0) * pow(1.0 - v.dot(h), 5);
  return slopes * fresnel * Mask(model, T(n.dot(l)), shape) * Mask(model, T(n.dot(v)), shape) /
         (4.0 * n.dot(v));
}

// f_d; variance is that of the facets' slopes.
template <typename T>
T Diffuse(model::DiffuseModel model, const T& variance, const Vector<T>& n, const Vector<T>& l,
          const Vector<T>& v) {
  using std::pow;
  const T nl = n.dot(l), nv = n.dot(v);
  if (model == model::DiffuseModel::kLambert) return nl;
  if (model == model::DiffuseModel::kCoated)
    return nl * (1.0 - pow(1.0 - nl, 5)) * (1.0 - pow(1.0 - nv, 5));
  const T a = 1.0 - 0.5 * variance / (variance + 0.33);
  const T b = 0.45 * variance / (variance + 0.09);
  const T s = l.dot(v) - nl * nv;
  return nl * (a + b * (s > T(0.0) ? s : T(0.0)) / (nl > nv ? nl : nv));
}

}  // namespace turnlight::estimator::textbook
