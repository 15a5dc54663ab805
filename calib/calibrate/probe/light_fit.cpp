#include "calib/calibrate/probe/light_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

namespace turnlight::calib::calibrate::probe {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kStep = 0.25;  // pixels, of differences

// Across what the spot shows: where the light is predicted, radians.
std::optional<Vector2d> Miss(const BallView& view, const Vector2d& pixel,
                             const Eigen::Matrix<double, 3, 2>& across, const Vector3d& reference,
                             const Vector3d& u, double rho) {
  const auto seen = MirrorAt(view, pixel);
  if (!seen) return std::nullopt;
  const Vector3d predicted = (u - rho * (seen->point - reference)).normalized();
  return across.transpose() * (predicted - seen->direction);
}

struct Equations {
  Matrix3d matrix = Matrix3d::Zero();
  Vector3d gradient = Vector3d::Zero();
  double chi_squared = 0.0;
};

bool Add(const BallView& view, const Sighting& sighting, const Vector3d& reference,
         const LightFit& fit, Equations& equations) {
  const auto seen = MirrorAt(view, sighting.pixel);
  if (!seen) return false;
  const Eigen::Matrix<double, 3, 2> across = Across(seen->direction);
  const auto miss = Miss(view, sighting.pixel, across, reference, fit.u, fit.rho);
  Matrix2d by_pixel;
  for (int axis = 0; axis < 2; ++axis) {
    const Vector2d step = kStep * Vector2d::Unit(axis);
    const auto after = Miss(view, sighting.pixel + step, across, reference, fit.u, fit.rho);
    const auto before = Miss(view, sighting.pixel - step, across, reference, fit.u, fit.rho);
    if (!after || !before) return false;
    by_pixel.col(axis) = (*after - *before) / (2.0 * kStep);
  }
  const Matrix2d covariance = by_pixel * sighting.covariance * by_pixel.transpose();
  const Matrix2d weight = covariance.inverse();
  if (!weight.allFinite()) return false;
  const Vector3d toward = fit.u - fit.rho * (seen->point - reference);
  const double length = toward.norm();
  const Vector3d unit = toward / length;
  Eigen::Matrix3d by_parameter;
  by_parameter.leftCols<2>() = Across(fit.u);
  by_parameter.col(2) = reference - seen->point;
  const Eigen::Matrix<double, 2, 3> jacobian =
      across.transpose() * (Matrix3d::Identity() - unit * unit.transpose()) / length * by_parameter;
  equations.matrix += jacobian.transpose() * weight * jacobian;
  equations.gradient += jacobian.transpose() * weight * *miss;
  equations.chi_squared += miss->dot(weight * *miss);
  return true;
}

std::optional<Equations> Build(const std::vector<BallView>& views,
                               const std::vector<Sighting>& sightings, const Vector3d& reference,
                               const LightFit& fit) {
  Equations equations;
  for (const Sighting& sighting : sightings)
    if (!Add(views[sighting.view], sighting, reference, fit, equations)) return std::nullopt;
  return equations;
}

// The inverse of the part that is fitted; nothing if that is singular. rho is scaled by the ball's
// radius, so that all parameters are angles.
std::optional<Matrix3d> Covariance(const Equations& equations, double radius, bool near) {
  const int size = near ? 3 : 2;
  const Vector3d scale(1.0, 1.0, 1.0 / radius);
  const Eigen::MatrixXd scaled =
      (scale.asDiagonal() * equations.matrix * scale.asDiagonal()).topLeftCorner(size, size);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
  constexpr double kSingular = 1e-10;
  if (!(eigen.eigenvalues()[0] > kSingular * eigen.eigenvalues()[size - 1])) return std::nullopt;
  Matrix3d covariance = Matrix3d::Zero();
  covariance.topLeftCorner(size, size) = scaled.inverse();
  return scale.asDiagonal() * covariance * scale.asDiagonal();
}

}  // namespace

std::optional<LightFit> FitLight(const std::vector<BallView>& views,
                                 const std::vector<Sighting>& sightings, const Vector3d& reference,
                                 bool near) {
  if (sightings.empty() || (near && sightings.size() < 2)) return std::nullopt;
  LightFit fit;
  Vector3d sum = Vector3d::Zero();
  for (const Sighting& sighting : sightings) {
    const auto seen = MirrorAt(views[sighting.view], sighting.pixel);
    if (!seen) return std::nullopt;
    sum += seen->direction;
  }
  fit.u = sum.normalized();
  const double radius = views[sightings.front().view].ball.radius;
  constexpr int kIterations = 50;
  constexpr double kConverged = 1e-12;  // radians
  for (int i = 0; i < kIterations; ++i) {
    const auto equations = Build(views, sightings, reference, fit);
    if (!equations) return std::nullopt;
    const auto covariance = Covariance(*equations, radius, near);
    if (!covariance) return std::nullopt;
    Vector3d step = -(*covariance * equations->gradient);
    constexpr double kLongest = 0.3;  // radians: beyond it, the equations are another's
    const double size = Vector3d(step[0], step[1], step[2] * radius).norm();
    if (size > kLongest) step *= kLongest / size;
    fit.u = (fit.u + Across(fit.u) * step.head<2>()).normalized();
    fit.rho += step[2];
    fit.covariance = *covariance;
    if (size < kConverged) break;
  }
  const auto equations = Build(views, sightings, reference, fit);
  if (!equations || !fit.u.allFinite() || !std::isfinite(fit.rho)) return std::nullopt;
  fit.chi_squared = equations->chi_squared;
  fit.freedom = 2 * static_cast<int>(sightings.size()) - (near ? 3 : 2);
  return fit;
}

}  // namespace turnlight::calib::calibrate::probe
