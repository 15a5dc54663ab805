#include "calib/calibrate/board/whole_boards.h"

#include <cstdlib>
#include <mrgingham/mrgingham.hh>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "calib/calibrate/board/saddle_points.h"

namespace turnlight::calib::calibrate::board {
namespace {

using Points = std::vector<Eigen::Vector2d>;

std::optional<Points> ByMrgingham(const cv::Mat& picture, int columns, int rows) {
  if (columns != rows) return std::nullopt;
  cv::Mat blurred;
  cv::blur(picture, blurred, {3, 3});  // its C++ call does not, and finds fewer boards without
  std::vector<mrgingham::PointDouble> found;
  signed char* levels = nullptr;
  const int level =
      mrgingham::find_chessboard_from_image_array(found, &levels, columns, blurred, -1);
  std::free(levels);
  if (level < 0) return std::nullopt;
  Points points;
  for (const auto& p : found) points.emplace_back(p.x, p.y);
  return points;
}

std::optional<Points> ByOpenCv(const cv::Mat& picture, int columns, int rows) {
  std::vector<cv::Point2f> found;
  if (!cv::findChessboardCornersSB(picture, {columns, rows}, found, cv::CALIB_CB_NORMALIZE_IMAGE)) {
    found.clear();
    if (!cv::findChessboardCorners(
            picture, {columns, rows}, found,
            cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_FAST_CHECK))
      return std::nullopt;
  }
  Points points;
  for (const auto& p : found) points.emplace_back(p.x, p.y);
  return points;
}

// Row by row; turned over if the columns go the wrong way round.
CornerLattice LatticeFrom(const cv::Mat& picture, Points points, int columns, int rows) {
  CornerLattice lattice;
  lattice.columns = columns;
  lattice.rows = rows;
  const auto at = [&](int column, int row) -> Eigen::Vector2d& {
    return points[lattice.Index(column, row)];
  };
  const Eigen::Vector2d along = at(columns - 1, 0) - at(0, 0);
  const Eigen::Vector2d down = at(0, rows - 1) - at(0, 0);
  if (along.x() * down.y() - along.y() * down.x() < 0.0)
    for (int row = 0; row < rows; ++row)
      for (int column = 0; column < columns / 2; ++column)
        std::swap(at(column, row), at(columns - 1 - column, row));
  lattice.corners.assign(points.begin(), points.end());
  const auto level = [&](int column, int row) {
    return LevelAt(picture, (at(column, row) + at(column + 1, row + 1)) / 2.0);
  };
  // Squares inside at even places have the colour of the one before corner (0, 0).
  double even = 0.0;
  double odd = 0.0;
  for (int row = 0; row + 1 < rows; ++row)
    for (int column = 0; column + 1 < columns; ++column)
      ((column + row) % 2 == 0 ? even : odd) += level(column, row);
  const double squares = (columns - 1.0) * (rows - 1.0);
  lattice.begins_dark =
      even / std::ceil(squares / 2.0) <= odd / std::max(1.0, std::floor(squares / 2.0));
  return lattice;
}

}  // namespace

std::optional<CornerLattice> FindWholeBoard(const cv::Mat& picture, int columns, int rows) {
  std::optional<Points> points;
  try {
    points = ByMrgingham(picture, columns, rows);
    if (!points) points = ByOpenCv(picture, columns, rows);
  } catch (const std::exception&) {
    return std::nullopt;  // what they cannot take is a picture in which they find nothing
  }
  const std::size_t all = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  if (!points || points->size() != all) return std::nullopt;
  cv::Mat levels;
  picture.convertTo(levels, CV_32F);
  return LatticeFrom(levels, std::move(*points), columns, rows);
}

}  // namespace turnlight::calib::calibrate::board
