#include "calib/calibrate/board/board.h"

namespace turnlight::calib::calibrate::board {
namespace {

void AddTag(const Eigen::Vector3d& corner, double side, std::vector<Eigen::Vector3d>& points) {
  points.push_back(corner);
  points.push_back(corner + Eigen::Vector3d(side, 0.0, 0.0));
  points.push_back(corner + Eigen::Vector3d(side, side, 0.0));
  points.push_back(corner + Eigen::Vector3d(0.0, side, 0.0));
}

}  // namespace

std::vector<Eigen::Vector3d> BoardPoints(const Board& board) {
  std::vector<Eigen::Vector3d> points;
  points.reserve(board.PointCount());
  for (int row = 0; row < board.rows; ++row)
    for (int column = 0; column < board.columns; ++column) {
      const Eigen::Vector3d corner(board.spacing * column, board.spacing * row, 0.0);
      if (board.kind == BoardKind::kAprilTagGrid)
        AddTag(corner, board.marker, points);
      else
        points.push_back(corner);
    }
  return points;
}

Pose PoseInMiddle(const Board& board) {
  const std::vector<Eigen::Vector3d> places = BoardPoints(board);
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& place : places) middle += place / static_cast<double>(places.size());
  Pose pose;
  pose.rotation = Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();
  pose.translation = -(pose.rotation * middle);
  return pose;
}

}  // namespace turnlight::calib::calibrate::board
