#include "calib/calibrate/lens/projection_difference.h"

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/format.h"

namespace turnlight::calib::calibrate::lens {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

struct Pair {
  Vector3d a, b;  // unit rays of a pixel
  double weight = 0.0;
};

// The rotation of least squared distances: where the fit below begins.
Matrix3d LeastSquares(const std::vector<Pair>& pairs) {
  Matrix3d sum = Matrix3d::Zero();
  for (const Pair& pair : pairs) sum += pair.weight * pair.b * pair.a.transpose();
  const Eigen::JacobiSVD<Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Vector3d sign(1.0, 1.0, 1.0);
  sign.z() = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  return svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
}

double Cost(const std::vector<Pair>& pairs, const Matrix3d& rotation) {
  double cost = 0.0;
  for (const Pair& pair : pairs) {
    const double off = pair.weight * (rotation * pair.a - pair.b).squaredNorm();
    cost += off * off;
  }
  return cost;
}

// A step of Newton's method on the cost, as a rotation vector.
Vector3d NewtonStep(const std::vector<Pair>& pairs, const Matrix3d& rotation) {
  Matrix3d hessian = Matrix3d::Zero();
  Vector3d gradient = Vector3d::Zero();
  for (const Pair& pair : pairs) {
    const Vector3d turned = rotation * pair.a, miss = turned - pair.b;
    const Vector3d pull = turned.cross(miss);  // half the derivative of the squared distance
    const double squared = miss.squaredNorm(), w = pair.weight * pair.weight;
    gradient += 4.0 * w * squared * pull;
    hessian += w * (8.0 * pull * pull.transpose() +
                    4.0 * squared * (Matrix3d::Identity() - turned * turned.transpose()));
  }
  hessian.diagonal().array() += 1e-12 * hessian.trace() + 1e-300;
  return -hessian.ldlt().solve(gradient);
}

Matrix3d Turned(const Vector3d& by, const Matrix3d& rotation) {
  const double angle = by.norm();
  if (!(angle > 0.0)) return rotation;
  return Eigen::AngleAxisd(angle, by / angle).toRotationMatrix() * rotation;
}

Matrix3d FitRotation(const std::vector<Pair>& pairs) {
  Matrix3d rotation = LeastSquares(pairs);
  double cost = Cost(pairs, rotation);
  for (int iteration = 0; iteration < 50; ++iteration) {
    const Vector3d step = NewtonStep(pairs, rotation);
    bool better = false;
    for (double length = 1.0; !better && length > 1e-4; length *= 0.5) {
      const Matrix3d next = Turned(length * step, rotation);
      const double next_cost = Cost(pairs, next);
      better = next_cost < cost * (1.0 - 1e-12);
      if (better) {
        rotation = next;
        cost = next_cost;
      }
    }
    if (!better) break;
  }
  return rotation;
}

}  // namespace

ImageGrid GridOverImage(int width, int height, int columns) {
  ImageGrid grid{
      columns,
      std::max(2, static_cast<int>(std::lround(static_cast<double>(height) / width * columns))),
      {}};
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column)
      grid.pixels.emplace_back((width - 1.0) * column / (grid.columns - 1),
                               (height - 1.0) * row / (grid.rows - 1));
  return grid;
}

Result<LensDifference> ProjectionDifference(const CameraModel& a, const CameraModel& b,
                                            const std::vector<Eigen::Vector2d>& pixels,
                                            const std::vector<double>& weights) {
  if (a.width() != b.width() || a.height() != b.height())
    return InputError(
        Format("two lenses are compared for pictures of one size, these are %d x %d "
               "and %d x %d",
               a.width(), a.height(), b.width(), b.height()));
  const auto rays_a = a.Unproject(pixels), rays_b = b.Unproject(pixels);
  std::vector<Pair> pairs;
  double largest = 0.0;
  for (const double weight : weights)
    if (std::isfinite(weight)) largest = std::max(largest, weight);
  for (std::size_t i = 0; i < pixels.size(); ++i)
    if (std::isfinite(weights[i]) && weights[i] > 0.0 && rays_a[i].allFinite() &&
        rays_b[i].allFinite())
      pairs.push_back({rays_a[i], rays_b[i], weights[i] / largest});
  if (pairs.size() < 3)
    return InputError(
        Format("two lenses are compared at %zu pixels, allowed are at least 3", pairs.size()));
  LensDifference difference{FitRotation(pairs), {}};
  std::vector<Vector3d> turned;
  for (const Vector3d& ray : rays_a) turned.push_back(difference.rotation * ray);
  difference.px = b.Project(turned);
  for (std::size_t i = 0; i < pixels.size(); ++i) difference.px[i] -= pixels[i];
  return difference;
}

}  // namespace turnlight::calib::calibrate::lens
