#include "calib/calibrate/drift/rig_change.h"

#include <Eigen/Dense>
#include <cmath>
#include <optional>

#include "calib/calibrate/placement/fit.h"

namespace turnlight::calib::calibrate::drift {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kFocalAndCentre = 4;  // of mrcal's intrinsics, of every lens model the first
// Steps nobody would overlook. What pictures cannot tell is taken to be 0 with these sigmas: of a
// camera that went round the axis and a camera that turned, they take the turn.
constexpr double kTurn = 1.0;         // radians
constexpr double kShift = 0.05;       // of the camera's distance
constexpr double kObjectShift = 0.5;  // of the camera's distance
constexpr double kScale = 0.1;        // degrees per degree
constexpr double kOffsetDeg = 30.0;
constexpr double kFocal = 0.3;              // of the focal length
constexpr double kCentre = 0.1;             // of the picture's width
constexpr double kLeastEigenvalue = 1e-10;  // of a correlation matrix

struct StoredPart {
  std::string key;
  Index at;
  const std::optional<MatrixXd>* covariance;
};

std::vector<StoredPart> PartsOf(const rig::CalibrationCovariances& known, const Layout& layout,
                                bool with_target) {
  std::vector<StoredPart> parts{{"camera_model", layout.intrinsics, &known.camera_model},
                                {"X_WC", layout.X_WC, &known.X_WC},
                                {"X_WA", layout.X_WA, &known.X_WA},
                                {"angle_scale", layout.angle_scale, &known.angle_scale},
                                {"angle_offset", layout.angle_offset, &known.angle_offset}};
  if (with_target) parts.push_back({"X_AT", layout.object, &known.X_AT});
  return parts;
}

// The blocks of parts that are in a joint covariance, those between them included.
void CopyJoint(const rig::JointCovariance& joint, const std::vector<StoredPart>& parts,
               const rig::CalibrationCovariances& known, MatrixXd& covariance) {
  struct Block {
    Index from, to, size;
  };
  std::vector<Block> blocks;
  Index at = 0;
  for (const std::string& key : joint.of) {
    Index size = known.X_AT ? known.X_AT->rows() : 0;
    for (const StoredPart& part : parts)
      if (part.key == key && *part.covariance) {
        size = (*part.covariance)->rows();
        blocks.push_back({at, part.at, size});
      }
    at += size;
  }
  for (const Block& row : blocks)
    for (const Block& column : blocks)
      covariance.block(row.to, column.to, row.size, column.size) =
          joint.matrix.block(row.from, column.from, row.size, column.size);
}

}  // namespace

std::string CauseName(Cause cause) {
  switch (cause) {
    case Cause::kCamera:
      return "camera";
    case Cause::kAngles:
      return "angles";
    case Cause::kLens:
      return "lens";
    case Cause::kTarget:
      return "target";
  }
  return "";
}

Layout::Layout(const rig::RigCalibration& calibration) {
  intrinsics = 0;
  X_WC = calibration.covariances.camera_model
             ? static_cast<Index>(calibration.lens.intrinsics().size())
             : kFocalAndCentre;
  X_WA = X_WC + 6;
  angle_scale = X_WA + 6;
  angle_offset = angle_scale + 1;
  object = angle_offset + 1;
  size = object + 6;
}

rig::RigCalibration Changed(const rig::RigCalibration& calibration, const Layout& layout,
                            const VectorXd& step) {
  rig::RigCalibration changed = calibration;
  std::vector<double> intrinsics = calibration.lens.intrinsics();
  for (Index i = 0; i < layout.X_WC; ++i) intrinsics[static_cast<std::size_t>(i)] += step[i];
  changed.lens = calibration.lens.WithIntrinsics(std::move(intrinsics));
  const auto moved = [&step](const Pose& pose, Index at) {
    return placement::Moved(pose, step.segment<3>(at), step.segment<3>(at + 3));
  };
  TurntableGeometry& geometry = changed.geometry;
  geometry.X_WC = moved(geometry.X_WC, layout.X_WC);
  geometry.X_WA = moved(geometry.X_WA, layout.X_WA);
  geometry.X_AT = moved(geometry.X_AT, layout.object);
  geometry.angle_scale += step[layout.angle_scale];
  geometry.angle_offset_deg += step[layout.angle_offset];
  return changed;
}

MatrixXd StoredRoot(const rig::RigCalibration& calibration, const Layout& layout,
                    bool with_target) {
  MatrixXd covariance = MatrixXd::Zero(layout.size, layout.size);
  const rig::CalibrationCovariances& known = calibration.covariances;
  const auto parts = PartsOf(known, layout, with_target);
  for (const StoredPart& part : parts)
    if (*part.covariance)
      covariance.block(part.at, part.at, (*part.covariance)->rows(), (*part.covariance)->cols()) =
          **part.covariance;
  if (known.joint) CopyJoint(*known.joint, parts, known, covariance);
  // By way of a unit diagonal: the numbers have different units.
  const VectorXd sigma = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  const VectorXd inverse = sigma.unaryExpr([](double s) { return s > 0.0 ? 1.0 / s : 0.0; });
  const MatrixXd correlation = inverse.asDiagonal() * covariance * inverse.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(correlation);
  std::vector<Index> kept;
  for (Index i = 0; i < layout.size; ++i)
    if (eigen.eigenvalues()[i] > kLeastEigenvalue) kept.push_back(i);
  MatrixXd root(layout.size, static_cast<Index>(kept.size()));
  for (std::size_t i = 0; i < kept.size(); ++i)
    root.col(static_cast<Index>(i)) = sigma.asDiagonal() * eigen.eigenvectors().col(kept[i]) *
                                      std::sqrt(eigen.eigenvalues()[kept[i]]);
  return root;
}

std::vector<std::string> WithoutCovariance(const rig::RigCalibration& calibration,
                                           bool with_target) {
  std::vector<std::string> missing;
  for (const StoredPart& part : PartsOf(calibration.covariances, Layout(calibration), with_target))
    if (!*part.covariance) missing.push_back(part.key);
  return missing;
}

double CameraDistance(const rig::RigCalibration& calibration) {
  return (calibration.geometry.X_WC.translation - calibration.geometry.X_WA.translation).norm();
}

MatrixXd StepsOf(Cause cause, const rig::RigCalibration& calibration, const Layout& layout) {
  const double distance = CameraDistance(calibration);
  const auto pose = [&layout](Index at, double shift) {
    MatrixXd steps = MatrixXd::Zero(layout.size, 6);
    steps.block<3, 3>(at, 0) = kTurn * Eigen::Matrix3d::Identity();
    steps.block<3, 3>(at + 3, 3) = shift * Eigen::Matrix3d::Identity();
    return steps;
  };
  if (cause == Cause::kCamera) return pose(layout.X_WC, kShift * distance);
  if (cause == Cause::kTarget) return pose(layout.object, kObjectShift * distance);
  MatrixXd steps = MatrixXd::Zero(layout.size, cause == Cause::kAngles ? 2 : 3);
  if (cause == Cause::kAngles) {
    steps(layout.angle_scale, 0) = kScale;
    steps(layout.angle_offset, 1) = kOffsetDeg;
    return steps;
  }
  for (const Index i : {0, 1})
    steps(i, 0) = kFocal * calibration.lens.intrinsics()[static_cast<std::size_t>(i)];
  for (const Index i : {1, 2}) steps(i + 1, i) = kCentre * calibration.lens.width();
  return steps;
}

}  // namespace turnlight::calib::calibrate::drift
