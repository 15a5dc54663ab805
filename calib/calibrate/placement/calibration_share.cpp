#include "calib/calibrate/placement/calibration_share.h"

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "base/angles.h"
#include "base/format.h"

namespace turnlight::calib::calibrate::placement {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

// Step of numerical derivatives by an intrinsic, in units of its sigma.
constexpr double kIntrinsicStep = 0.1;

Matrix3d Cross(const Vector3d& v) {
  Matrix3d matrix;
  matrix << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return matrix;
}

// Derivatives of a point in C by the poses and angles of the rig, in their files' parameters.
struct ByGeometry {
  Eigen::Matrix<double, 3, 6> X_WC, X_WA;
  Vector3d angle_scale, angle_offset;  // by deg/deg and by deg
};

ByGeometry PointByGeometry(const calib::TurntableGeometry& geometry, double angle_deg,
                           const Vector3d& p_A) {
  const double turned = DegToRad(geometry.angle_scale * angle_deg + geometry.angle_offset_deg);
  const Vector3d p_table = Eigen::AngleAxisd(turned, Vector3d::UnitZ()) * p_A;
  const Vector3d turned_A = geometry.X_WA.rotation * p_table;  // seen from A's origin, in W's axes
  const Vector3d from_camera = turned_A + geometry.X_WA.translation - geometry.X_WC.translation;
  const Matrix3d R_CW = geometry.X_WC.rotation.transpose();
  ByGeometry by;
  by.X_WC << R_CW * Cross(from_camera), -R_CW;
  by.X_WA << -R_CW * Cross(turned_A), R_CW;
  by.angle_offset =
      R_CW * geometry.X_WA.rotation * Vector3d::UnitZ().cross(p_table) * DegToRad(1.0);
  by.angle_scale = by.angle_offset * angle_deg;
  return by;
}

// The sum of gain_i * d value_i / d calibration, gain_i being what residual i moves the parameters.
struct Sums {
  MatrixXd X_WC = MatrixXd::Zero(kParameters, 6), X_WA = MatrixXd::Zero(kParameters, 6);
  MatrixXd angle_scale = MatrixXd::Zero(kParameters, 1);
  MatrixXd angle_offset = MatrixXd::Zero(kParameters, 1);
};

void AddShare(const MatrixXd& sum, const std::optional<MatrixXd>& covariance, MatrixXd& share) {
  if (covariance) share += sum * *covariance * sum.transpose();
}

std::optional<calib::CameraModel> WithIntrinsics(const calib::CameraModel& camera,
                                                 const std::vector<double>& intrinsics) {
  std::string values;
  for (const double value : intrinsics) values += NumberText(value, 17) + ", ";
  auto model = calib::CameraModel::FromString(
      "{ 'lensmodel': '" + camera.lens_model() + "', 'intrinsics': [ " + values +
          " ], 'extrinsics': [ 0, 0, 0, 0, 0, 0 ], 'imagersize': [ " +
          std::to_string(camera.width()) + ", " + std::to_string(camera.height()) + " ] }",
      camera.lens_model());
  if (!model) return std::nullopt;
  return std::move(*model);
}

// The lens: an intrinsic moves the image of what a measured point's ray meets.
MatrixXd LensShare(const Problem& problem, const Fit& fit, const MatrixXd& gains) {
  const auto& covariance = problem.calibration.covariances.camera_model;
  const calib::CameraModel& camera = problem.calibration.lens;
  MatrixXd sum = MatrixXd::Zero(kParameters, static_cast<Eigen::Index>(camera.intrinsics().size()));
  if (!covariance) return MatrixXd::Zero(kParameters, kParameters);
  std::vector<Eigen::Vector2d> pixels;
  for (const Residual& residual : fit.residuals) pixels.push_back(residual.pixel);
  const std::vector<Vector3d> rays = camera.Unproject(pixels);
  const std::vector<Eigen::Vector2d> before = camera.Project(rays);
  for (Eigen::Index k = 0; k < sum.cols(); ++k) {
    const double step = kIntrinsicStep * std::sqrt((*covariance)(k, k));
    if (!(step > 0.0)) continue;
    std::vector<double> intrinsics = camera.intrinsics();
    intrinsics[static_cast<std::size_t>(k)] += step;
    const auto moved = WithIntrinsics(camera, intrinsics);
    if (!moved) continue;
    const std::vector<Eigen::Vector2d> after = moved->Project(rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const double by = -fit.residuals[i].normal.dot(after[i] - before[i]) / step;
      if (std::isfinite(by)) sum.col(k) += gains.col(static_cast<Eigen::Index>(i)) * by;
    }
  }
  return sum * *covariance * sum.transpose();
}

}  // namespace

MatrixXd CalibrationShare(const Problem& problem, const Fit& fit, const MatrixXd& inverse) {
  const calib::TurntableGeometry& geometry = problem.calibration.geometry;
  const double noise = fit.scale * fit.scale * fit.correlation;
  MatrixXd gains = MatrixXd::Zero(kParameters, static_cast<Eigen::Index>(fit.residuals.size()));
  Sums sums;
  for (std::size_t i = 0; i < fit.residuals.size(); ++i) {
    if (!fit.used[i]) continue;
    const Residual& residual = fit.residuals[i];
    const double angle_deg = problem.views[residual.view].angle_deg;
    const Row row = ParameterRow(residual, fit.state, PoseOfTableInCamera(geometry, angle_deg));
    const VectorXd gain = -inverse * row.transpose() / (noise * residual.sigma * residual.sigma);
    gains.col(static_cast<Eigen::Index>(i)) = gain;
    const ByGeometry by = PointByGeometry(geometry, angle_deg, residual.p_A);
    sums.X_WC += gain * (residual.by_p_C * by.X_WC);
    sums.X_WA += gain * (residual.by_p_C * by.X_WA);
    sums.angle_scale += gain * (residual.by_p_C * by.angle_scale);
    sums.angle_offset += gain * (residual.by_p_C * by.angle_offset);
  }
  const rig::CalibrationCovariances& known = problem.calibration.covariances;
  MatrixXd share = LensShare(problem, fit, gains);
  AddShare(sums.X_WC, known.X_WC, share);
  AddShare(sums.X_WA, known.X_WA, share);
  AddShare(sums.angle_scale, known.angle_scale, share);
  AddShare(sums.angle_offset, known.angle_offset, share);
  return share;
}

}  // namespace turnlight::calib::calibrate::placement
