#include "tests/calib/calibrate/axis/turning_board.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "base/angles.h"
#include "base/random.h"
#include "calib/calibrate/axis/board_pose.h"
#include "calib/calibrate/board/number_lattice.h"

namespace turnlight::calib::calibrate::axis {

SimulatedTable TableWithBoard() {
  SimulatedTable table;
  table.board.columns = table.board.rows = 10;
  table.board.spacing = 10.0;
  table.geometry.X_WC = LookAtOrigin(0.0, DegToRad(35.0), 480.0);
  table.geometry.X_AT = Turn(Eigen::Vector3d::UnitX(), DegToRad(180.0));
  table.geometry.X_AT = Turn(Eigen::Vector3d::UnitZ(), 0.3) * table.geometry.X_AT;
  table.geometry.X_AT.translation = {-20.0, 65.0, 0.0};
  return table;
}

std::vector<AxisView> SimulateViews(const SimulatedTable& table,
                                    const std::vector<double>& angles_deg) {
  const RandomStream corners(table.seed, 1), angles(table.seed, 2), numbers(table.seed, 3);
  const auto points = BoardPoints(table.board);
  const auto turns = SameLookingTurns(table.board);
  std::vector<AxisView> views;
  for (std::size_t i = 0; i < angles_deg.size(); ++i) {
    AxisView& view = views.emplace_back();
    view.angle_deg = angles_deg[i];
    double play = 0.0;
    if (i > 0) {
      view.approach = angles_deg[i] > angles_deg[i - 1] ? Approach::kRising : Approach::kFalling;
      play = (*view.approach == Approach::kRising ? -0.5 : 0.5) * table.backlash_deg;
    }
    TurntableGeometry geometry = table.geometry;
    geometry.angle_offset_deg += table.angle_noise_deg * angles.Normal(i);
    const RigPoses poses = PosesAt(geometry, angles_deg[i] + play);
    const Pose X_CB = poses.X_WC.Inverse() * poses.X_WT;
    const std::size_t turn =
        table.numbers_anyhow
            ? static_cast<std::size_t>(numbers.Uniform(i) * static_cast<double>(turns.size()))
            : 0;
    std::vector<Eigen::Vector3d> p_C;
    for (const Eigen::Vector3d& p : points) p_C.push_back(X_CB * (turns[turn] * p));
    const auto pixels = table.camera.Project(p_C);
    for (std::size_t k = 0; k < pixels.size(); ++k) {
      const std::uint64_t at = 2 * (i * points.size() + k);
      const Eigen::Vector2d pixel =
          pixels[k] +
          table.corner_noise_px * Eigen::Vector2d(corners.Normal(at), corners.Normal(at + 1));
      if (pixel.x() > 0 && pixel.y() > 0 && pixel.x() < table.camera.width() - 1 &&
          pixel.y() < table.camera.height() - 1)
        view.board.points.push_back({k, pixel, 1.0});
    }
  }
  return views;
}

std::vector<double> Angles(double first, double step, int count) {
  std::vector<double> angles;
  for (int i = 0; i < count; ++i) angles.push_back(first + step * i);
  return angles;
}

AxisError ErrorOf(const AxisCalibration& found, const SimulatedTable& table) {
  const Pose X_CA = table.geometry.X_WC.Inverse() * table.geometry.X_WA;
  const Eigen::Matrix<double, 3, 2> across = found.X_WC.Inverse().rotation.leftCols<2>();
  const Eigen::Vector3d u = X_CA.rotation.col(2);
  const Eigen::Vector3d away = found.origin_C - X_CA.translation;
  return {across.transpose() * (found.direction_C - u) * RadToDeg(1.0),
          across.transpose() * (away - u * u.dot(away))};
}

double SquaredSigmas(const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance) {
  return error.dot(covariance.ldlt().solve(error));
}

Eigen::Matrix<double, 6, 1> CameraError(const AxisCalibration& found, const SimulatedTable& table) {
  const Eigen::AngleAxisd turn(found.X_WC.rotation * table.geometry.X_WC.rotation.transpose());
  Eigen::Matrix<double, 6, 1> error;
  error << turn.angle() * turn.axis(), found.X_WC.translation - table.geometry.X_WC.translation;
  return error;
}

}  // namespace turnlight::calib::calibrate::axis
