// Where the optimizer begins: a focal length and the boards' poses, from nothing but the corners.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "calib/calibrate/board/board.h"
#include "calib/calibrate/lens/problem.h"
#include "calib/pose.h"

namespace turnlight::calib::calibrate::lens {

// The pose X_CB of a board whose points p_B (z = 0) are seen along the rays v_C, at any angle from
// the axis; by a homography from board to rays, so without noise it is exact. Nothing if the points
// are too few or on a line.
std::optional<Pose> PoseFromRays(const std::vector<Eigen::Vector3d>& p_B,
                                 const std::vector<Eigen::Vector3d>& v_C);

// A lens with a focal length and a centre alone, fitted to the views.
struct Seed {
  mrcal_lensmodel_t model{};  // pinhole or stereographic
  std::array<double, 4> core{};
  std::vector<mrcal_pose_t> poses;  // of all views
  double median_px = 0.0;           // over the views, of their rms distance
};

// The best one of each of the two simple lenses, better one first; empty if no view gives a pose.
// They are fitted to at most 24 views, from focal lengths between a quarter of the picture's longer
// side and eight times of it.
std::vector<Seed> FindSeeds(const std::array<int, 2>& image_size, const board::Board& board,
                            const std::vector<board::BoardView>& views);

// Poses of the views through a known lens; identity where there is none.
std::vector<mrcal_pose_t> PosesThrough(const mrcal_lensmodel_t& model,
                                       const std::vector<double>& intrinsics,
                                       const board::Board& board,
                                       const std::vector<board::BoardView>& views);

}  // namespace turnlight::calib::calibrate::lens
