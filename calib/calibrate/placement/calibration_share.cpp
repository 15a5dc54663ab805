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

// The sum of gain_i * d value_i / d calibration, gain_i being what residual i moves the parameters.
struct Sums {
  MatrixXd X_WC = MatrixXd::Zero(kParameters, 6), X_WA = MatrixXd::Zero(kParameters, 6);
  MatrixXd angle_scale = MatrixXd::Zero(kParameters, 1);
  MatrixXd angle_offset = MatrixXd::Zero(kParameters, 1);
};

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
MatrixXd LensTransfer(const Problem& problem, const Fit& fit, const MatrixXd& gains) {
  const auto& covariance = problem.calibration.covariances.camera_model;
  const calib::CameraModel& camera = problem.calibration.lens;
  MatrixXd sum = MatrixXd::Zero(kParameters, static_cast<Eigen::Index>(camera.intrinsics().size()));
  if (!covariance) return sum;
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
  return sum;
}

// What each residual used moves the parameters by.
MatrixXd GainsOf(const Problem& problem, const Fit& fit, const MatrixXd& inverse) {
  const double noise = fit.scale * fit.scale * fit.correlation;
  MatrixXd gains = MatrixXd::Zero(kParameters, static_cast<Eigen::Index>(fit.residuals.size()));
  for (std::size_t i = 0; i < fit.residuals.size(); ++i) {
    if (!fit.used[i]) continue;
    const Residual& residual = fit.residuals[i];
    const Row row = ParameterRow(
        residual, fit.state,
        PoseOfTableInCamera(problem.calibration.geometry, problem.views[residual.view].angle_deg));
    gains.col(static_cast<Eigen::Index>(i)) =
        -inverse * row.transpose() / (noise * residual.sigma * residual.sigma);
  }
  return gains;
}

Sums SumOverResiduals(const Problem& problem, const Fit& fit, const MatrixXd& gains) {
  Sums sums;
  for (std::size_t i = 0; i < fit.residuals.size(); ++i) {
    if (!fit.used[i]) continue;
    const Residual& residual = fit.residuals[i];
    const VectorXd gain = gains.col(static_cast<Eigen::Index>(i));
    const ByGeometry by = PointByGeometry(problem.calibration.geometry,
                                          problem.views[residual.view].angle_deg, residual.p_A);
    sums.X_WC += gain * (residual.by_p_C * by.X_WC);
    sums.X_WA += gain * (residual.by_p_C * by.X_WA);
    sums.angle_scale += gain * (residual.by_p_C * by.angle_scale);
    sums.angle_offset += gain * (residual.by_p_C * by.angle_offset);
  }
  return sums;
}

struct Part {
  std::string key;
  const std::optional<MatrixXd>* covariance;
  MatrixXd transfer;
};

// Where a part begins in a matrix of several; nothing if it is not among them.
std::optional<Eigen::Index> PlaceOf(const std::string& key, const std::vector<std::string>& of,
                                    const std::vector<Eigen::Index>& sizes) {
  Eigen::Index at = 0;
  for (std::size_t i = 0; i < of.size(); ++i) {
    if (of[i] == key) return at;
    at += sizes[i];
  }
  return std::nullopt;
}

// The blocks of a joint covariance between parts that are both in it.
void CopyJoint(const rig::JointCovariance& joint, const std::vector<Part>& parts,
               CalibrationShare& share) {
  std::vector<Eigen::Index> sizes, joint_sizes;
  for (const Part& part : parts) sizes.push_back((*part.covariance)->rows());
  for (const std::string& key : joint.of) {
    joint_sizes.push_back(6);  // X_AT's, which is no part
    for (const Part& part : parts)
      if (part.key == key) joint_sizes.back() = (*part.covariance)->rows();
  }
  for (std::size_t i = 0; i < parts.size(); ++i)
    for (std::size_t j = 0; j < parts.size(); ++j) {
      const auto row = PlaceOf(parts[i].key, joint.of, joint_sizes);
      const auto column = PlaceOf(parts[j].key, joint.of, joint_sizes);
      if (!row || !column) continue;
      share.covariance.block(*PlaceOf(parts[i].key, share.of, sizes),
                             *PlaceOf(parts[j].key, share.of, sizes), sizes[i], sizes[j]) =
          joint.matrix.block(*row, *column, sizes[i], sizes[j]);
    }
}

}  // namespace

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

CalibrationShare ShareOfCalibration(const Problem& problem, const Fit& fit,
                                    const MatrixXd& inverse) {
  const MatrixXd gains = GainsOf(problem, fit, inverse);
  const Sums sums = SumOverResiduals(problem, fit, gains);
  const rig::CalibrationCovariances& known = problem.calibration.covariances;
  std::vector<Part> parts{{"camera_model", &known.camera_model, LensTransfer(problem, fit, gains)},
                          {"X_WC", &known.X_WC, sums.X_WC},
                          {"X_WA", &known.X_WA, sums.X_WA},
                          {"angle_scale", &known.angle_scale, sums.angle_scale},
                          {"angle_offset", &known.angle_offset, sums.angle_offset}};
  std::erase_if(parts, [](const Part& part) { return !part.covariance->has_value(); });
  Eigen::Index size = 0;
  for (const Part& part : parts) size += part.transfer.cols();
  CalibrationShare share{{}, MatrixXd::Zero(size, size), MatrixXd::Zero(kParameters, size)};
  Eigen::Index at = 0;
  for (const Part& part : parts) {
    const Eigen::Index columns = part.transfer.cols();
    share.of.push_back(part.key);
    share.covariance.block(at, at, columns, columns) = **part.covariance;
    share.transfer.middleCols(at, columns) = part.transfer;
    at += columns;
  }
  if (known.joint) CopyJoint(*known.joint, parts, share);
  return share;
}

}  // namespace turnlight::calib::calibrate::placement
