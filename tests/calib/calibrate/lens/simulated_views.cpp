#include "simulated_views.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/angles.h"
#include "base/format.h"
#include "base/random.h"

namespace turnlight::calib::calibrate::lens {
namespace {

// The board's middle along the ray of a random pixel, tilted about its own axes.
Pose RandomPose(const CameraModel& camera, const board::Board& board, const SimulatedViews& how,
                std::uint64_t picture) {
  const RandomStream random(how.pose_seed, 100 + picture);
  const Eigen::Vector2d pixel(random.Uniform(0, 0.12, 0.88) * camera.width(),
                              random.Uniform(1, 0.12, 0.88) * camera.height());
  const double size = board.spacing * (std::max(board.columns, board.rows) - 1);
  const double distance = size * camera.intrinsics()[0] /
                          (how.width_share * random.Uniform(2, 0.8, 1.25) * camera.width());
  const double tilt = DegToRad(how.tilt_deg);
  Pose pose;
  pose.rotation = (Eigen::AngleAxisd(random.Uniform(3, -tilt, tilt), Eigen::Vector3d::UnitX()) *
                   Eigen::AngleAxisd(random.Uniform(4, -tilt, tilt), Eigen::Vector3d::UnitY()) *
                   Eigen::AngleAxisd(random.Uniform(5, -0.5, 0.5), Eigen::Vector3d::UnitZ()))
                      .toRotationMatrix();
  const Eigen::Vector3d middle(0.5 * board.spacing * (board.columns - 1),
                               0.5 * board.spacing * (board.rows - 1), 0.0);
  const Eigen::Vector3d ray = camera.Unproject({pixel}).front();
  pose.translation = distance / ray.z() * ray - pose.rotation * middle;
  return pose;
}

double Bend(int i, int count) {
  const double x = static_cast<double>(i) / (count - 1);
  return 4.0 * x * (1.0 - x);
}

}  // namespace

CameraModel ExampleLens() {
  return *CameraModel::FromString(
      "{'lensmodel': 'LENSMODEL_OPENCV8', 'extrinsics': [0,0,0,0,0,0], 'imagersize': [2000, 1400],"
      " 'intrinsics': [1800, 1795, 1012, 688, -0.21, 0.11, 3e-4, -5e-4, -0.02, 0.05, 0.02, -0.01]}",
      "example");
}

board::Board ExampleBoard(int columns, int rows) {
  return {board::BoardKind::kChessboard, columns, rows, 20.0, 0.0, ""};
}

std::vector<PictureViews> SimulateViews(const CameraModel& camera, const board::Board& board,
                                        const SimulatedViews& how) {
  std::vector<Eigen::Vector3d> p_B = board::BoardPoints(board);
  if (board.kind != board::BoardKind::kAprilTagGrid)
    for (std::size_t i = 0; i < p_B.size(); ++i)
      p_B[i].z() = how.warp.x() * Bend(static_cast<int>(i) % board.columns, board.columns) +
                   how.warp.y() * Bend(static_cast<int>(i) / board.columns, board.rows) +
                   how.wave * std::sin(9.0 * p_B[i].x() / (board.spacing * board.columns) +
                                       0.2 * p_B[i].y() / board.spacing);
  std::vector<PictureViews> pictures;
  for (int k = 0; k < how.pictures; ++k) {
    const Pose X_CB = RandomPose(camera, board, how, static_cast<std::uint64_t>(k));
    std::vector<Eigen::Vector3d> p_C;
    for (const Eigen::Vector3d& p : p_B) p_C.push_back(X_CB * p);
    const auto pixels = camera.Project(p_C);
    const RandomStream noise(how.noise_seed, 1000 + static_cast<std::uint64_t>(k));
    board::BoardView view;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const Eigen::Vector2d pixel =
          pixels[i] + how.noise_px * Eigen::Vector2d(noise.Normal(2 * i), noise.Normal(2 * i + 1));
      if (pixel.x() >= 0.0 && pixel.y() >= 0.0 && pixel.x() <= camera.width() - 1 &&
          pixel.y() <= camera.height() - 1)
        view.points.push_back({i, pixel, 1.0});
    }
    pictures.push_back({Format("p%02d", k), camera.width(), camera.height(), {view}, ""});
  }
  return pictures;
}

}  // namespace turnlight::calib::calibrate::lens
