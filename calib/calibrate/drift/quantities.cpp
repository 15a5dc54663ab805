#include "calib/calibrate/drift/quantities.h"

#include <Eigen/Dense>
#include <cmath>

#include "base/angles.h"

namespace turnlight::calib::calibrate::drift {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

// Of a quantity, in variances; less of it is only what it has in common with others.
constexpr double kToldShare = 0.02;

// A quantity as a linear map of the step.
struct Mapped {
  std::string key, words, unit;
  MatrixXd map;
};

Matrix3d CrossOf(const Vector3d& v) {
  Matrix3d matrix;
  matrix << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return matrix;
}

double SigmaAlong(const VectorXd& value, const MatrixXd& covariance) {
  if (value.norm() > 0.0) {
    const VectorXd along = value.normalized();
    return std::sqrt(std::max(0.0, along.dot(covariance * along)));
  }
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(covariance);
  return std::sqrt(std::max(0.0, eigen.eigenvalues().maxCoeff()));
}

void AddPose(const std::string& what, const std::string& words, Eigen::Index at,
             const Layout& layout, const std::string& unit, std::vector<Mapped>& mapped) {
  MatrixXd turn = MatrixXd::Zero(3, layout.size), shift = turn;
  turn.middleCols<3>(at) = RadToDeg(1.0) * Matrix3d::Identity();
  shift.middleCols<3>(at + 3) = Matrix3d::Identity();
  mapped.push_back({what + "_turned_deg", words + " turned by", "deg", turn});
  mapped.push_back({what + "_moved", words + " moved by", unit, shift});
}

// How the axis lies in the camera's picture of the world: nothing that goes along or about the axis
// changes it.
void AddAxis(const rig::RigCalibration& stored, const Layout& layout, std::vector<Mapped>& mapped) {
  const Pose& X_WA = stored.geometry.X_WA;
  const Vector3d from_camera = X_WA.translation - stored.geometry.X_WC.translation;
  const Eigen::Matrix<double, 2, 3> across = X_WA.rotation.leftCols<2>().transpose();
  MatrixXd direction = MatrixXd::Zero(2, layout.size), place = direction;
  direction.middleCols<3>(layout.X_WC) = RadToDeg(1.0) * across * CrossOf(X_WA.rotation.col(2));
  place.middleCols<3>(layout.X_WC) = across * CrossOf(from_camera);
  place.middleCols<3>(layout.X_WC + 3) = -across;
  mapped.push_back({"axis_direction_deg", "the axis's direction seen from the camera changed by",
                    "deg", direction});
  mapped.push_back({"axis_place", "the axis's place seen from the camera changed by",
                    stored.length_unit, place});
}

void AddAngles(const Layout& layout, std::vector<Mapped>& mapped) {
  MatrixXd scale = MatrixXd::Zero(1, layout.size), offset = scale;
  scale(0, layout.angle_scale) = 360.0;
  offset(0, layout.angle_offset) = 1.0;
  mapped.push_back({"angle_scale_deg_per_turn", "a turn of the table is longer by", "deg", scale});
  mapped.push_back({"angle_offset_deg", "the table's zero is off by", "deg", offset});
}

void AddLens(const rig::RigCalibration& stored, const Layout& layout, std::vector<Mapped>& mapped) {
  MatrixXd focal = MatrixXd::Zero(1, layout.size);
  focal(0, 0) = 100.0 / stored.lens.intrinsics()[0];
  MatrixXd centre = MatrixXd::Zero(2, layout.size);
  centre(0, 2) = centre(1, 3) = 1.0;
  mapped.push_back({"focal_length_percent", "the focal length is longer by", "%", focal});
  mapped.push_back({"image_centre_px", "the image centre moved by", "px", centre});
}

}  // namespace

std::vector<Quantity> QuantitiesOf(const HypothesisFit& fit, const rig::RigCalibration& stored) {
  const Layout layout(stored);
  std::vector<Mapped> mapped;
  for (const Cause cause : fit.hypothesis.causes) {
    if (cause == Cause::kCamera) {
      AddPose("camera", "the camera", layout.X_WC, layout, stored.length_unit, mapped);
      AddAxis(stored, layout, mapped);
    }
    if (cause == Cause::kAngles) AddAngles(layout, mapped);
    if (cause == Cause::kLens) AddLens(stored, layout, mapped);
    if (cause == Cause::kTarget)
      AddPose("target", "the target", layout.object, layout, stored.length_unit, mapped);
  }
  std::vector<Quantity> quantities;
  for (const Mapped& one : mapped) {
    const VectorXd value = one.map * fit.drift;
    const MatrixXd covariance = one.map * fit.covariance * one.map.transpose();
    const double told = (one.map * fit.told * one.map.transpose()).trace();
    const double could_be = (one.map * fit.could_be * one.map.transpose()).trace();
    if (!(told > kToldShare * could_be)) continue;
    quantities.push_back({one.key, one.words, one.unit, value.size() == 1 ? value[0] : value.norm(),
                          SigmaAlong(value, covariance),
                          SigmaAlong(value, one.map * fit.from_pictures * one.map.transpose())});
  }
  return quantities;
}

}  // namespace turnlight::calib::calibrate::drift
