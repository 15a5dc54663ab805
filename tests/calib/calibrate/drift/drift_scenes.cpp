#include "tests/calib/calibrate/drift/drift_scenes.h"

#include "base/angles.h"
#include "base/random.h"
#include "tests/calib/calibrate/placement/outline_scenes.h"

namespace turnlight::calib::calibrate::drift {

axis::SimulatedTable NoisyBoardTable(std::uint64_t seed) {
  axis::SimulatedTable table = axis::TableWithBoard();
  table.corner_noise_px = 0.3;
  table.angle_noise_deg = 0.05;
  table.numbers_anyhow = true;
  table.seed = seed;
  return table;
}

rig::RigCalibration CalibratedOn(const axis::SimulatedTable& table) {
  const auto found = axis::CalibrateAxis(table.board, table.camera,
                                         axis::SimulateViews(table, axis::Angles(0, 10, 36)));
  rig::RigCalibration rig(table.camera);
  rig.target_placed = false;
  rig.devices.resolution = {table.camera.width(), table.camera.height()};
  if (!found) return rig;
  rig.geometry.X_WC = found->X_WC;
  rig.geometry.angle_scale = found->angle_scale;
  rig.covariances.camera_model = Eigen::MatrixXd::Zero(4, 4);
  rig.covariances.X_WC = found->covariance.topLeftCorner(6, 6);
  rig.covariances.X_WA = Eigen::MatrixXd::Zero(6, 6);
  rig.covariances.angle_scale = found->covariance.bottomRightCorner(1, 1);
  rig.covariances.angle_offset = Eigen::MatrixXd::Zero(1, 1);
  rig.covariances.joint = rig::JointCovariance{{"X_WC", "angle_scale"}, found->covariance};
  return rig;
}

axis::SimulatedTable LaterThan(const axis::SimulatedTable& table, std::uint64_t seed) {
  axis::SimulatedTable later = table;
  const RandomStream random(seed, 1u << 20);
  later.geometry.X_AT =
      Turn(Eigen::Vector3d::UnitZ(), random.Uniform(0, -1.0, 1.0)) * table.geometry.X_AT;
  later.geometry.X_AT.translation +=
      Eigen::Vector3d(random.Uniform(1, -15.0, 15.0), random.Uniform(2, -15.0, 15.0), 0.0);
  later.seed = seed;
  return later;
}

void TurnCamera(TurntableGeometry& geometry, int about, double degrees) {
  Pose& X_WC = geometry.X_WC;
  X_WC.rotation = Turn(X_WC.rotation.col(about), DegToRad(degrees)).rotation * X_WC.rotation;
}

void ShiftCamera(TurntableGeometry& geometry, int along, double length) {
  geometry.X_WC.translation += length * geometry.X_WC.rotation.col(along);
}

rig::RigCalibration PlacedRig() {
  rig::RigCalibration rig = placement::SampleRig();
  rig.geometry.X_AT = placement::RandomPlace(RandomStream(5, 5));
  Eigen::VectorXd sigma(6);
  sigma << 1e-4, 1e-4, 1e-4, 0.02, 0.02, 0.02;
  const Eigen::MatrixXd pose = sigma.cwiseAbs2().asDiagonal();
  rig.covariances.camera_model = Eigen::MatrixXd::Zero(12, 12);
  rig.covariances.X_WC = pose;
  rig.covariances.X_WA = Eigen::MatrixXd::Zero(6, 6);
  rig.covariances.X_AT = pose;
  rig.covariances.angle_scale = Eigen::MatrixXd::Constant(1, 1, 1e-8);
  rig.covariances.angle_offset = Eigen::MatrixXd::Zero(1, 1);
  return rig;
}

}  // namespace turnlight::calib::calibrate::drift
