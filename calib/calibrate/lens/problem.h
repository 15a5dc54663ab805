// mrcal's optimization problem of one camera that sees boards, each at a pose of its own, in
// mrcal's own types. Only this folder includes it.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <array>
#include <string>
#include <vector>

#include "calib/calibrate/board/board.h"
#include "calib/pose.h"

extern "C" {
#include <mrcal/mrcal.h>
}

namespace turnlight::calib::calibrate::lens {

// mrcal's boards are regular grids of points, of which a view may lack any. A chessboard is one;
// the corners of a grid of tags are some points of a finer one.
struct PointGrid {
  int columns = 0, rows = 0;
  double spacing = 0.0;
  std::vector<int> cells;  // of the board's points by their number; -1: not in this grid
};
PointGrid GridOfBoard(const board::Board& board);
// One point of each tag is enough to begin with; of other boards all points.
PointGrid CoarseGridOfBoard(const board::Board& board);

struct Problem {
  mrcal_lensmodel_t model{};
  std::array<int, 2> image_size{};
  PointGrid grid;
  std::vector<double> intrinsics;
  std::vector<mrcal_pose_t> poses;       // X_CB of each view, as rotation vector and shift
  mrcal_calobject_warp_t warp{};         // 0: flat
  std::vector<mrcal_point3_t> observed;  // grid's points of each view: pixel, weight; -1: not used

  std::size_t points_per_view() const {
    return static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows);
  }
};

mrcal_lensmodel_t LensModelOf(const std::string& full_name);
// The observations of a view on a grid, in the order of the grid's points.
std::vector<mrcal_point3_t> Observations(const PointGrid& grid, const board::BoardView& view);
Pose ToPose(const mrcal_pose_t& pose);
mrcal_pose_t ToMrcal(const Pose& pose);

// What is solved for; the boards' poses always are.
struct Pass {
  bool core = false, distortions = false, warp = false;
  bool regularized = false;
  bool rejects_outliers = false;  // marks them in Problem::observed by weights below 0
};
// Moves the problem to its optimum. False if mrcal gives up or a number is not finite.
bool Optimize(Problem& problem, const Pass& pass);

// At the problem's own values: residuals and their derivatives, in mrcal's packed state.
struct Linearization {
  Eigen::SparseMatrix<double, Eigen::RowMajor> jacobian;  // measurements x packed state
  Eigen::VectorXd residuals;                              // weighted, pixels; 0 where not used
  Eigen::Index observation_rows = 0;                      // these come first, then what regularizes
  Eigen::VectorXd scales;                                 // state = scales * packed state
  int intrinsics_index = -1, intrinsics_count = 0, poses_index = -1, warp_index = -1;
};
Linearization Linearize(const Problem& problem, const Pass& pass);

// p_B of the grid's points, bent by the warp.
std::vector<Eigen::Vector3d> BentPoints(const PointGrid& grid, const mrcal_calobject_warp_t& warp);
// Observed less projected pixels of a view's points; NaN where there is no observation.
std::vector<Eigen::Vector2d> Residuals(const Problem& problem, std::size_t view);

}  // namespace turnlight::calib::calibrate::lens
