// A board as the plane that a hand-held camera is registered by.
//
// Frame W: origin in the middle of the board's points, x along its rows, z out of its printed side,
// towards who looks at it.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calib/calibrate/board/board.h"
#include "calib/calibrate/board/detect_boards.h"
#include "calib/calibrate/handheld/registration.h"
#include "calib/pose.h"

namespace turnlight::calib::calibrate::handheld {

struct BoardPlane {
  std::vector<Eigen::Vector3d> places;  // p_B of its points, by number
  Pose X_WB;
  RegistrationOptions options;  // of corners that were found; the step is the caller's
};
BoardPlane PlaneOf(const board::Board& board);

// What a picture of that name shows of it: the board of most points, or why there is none.
PlaneView ViewOf(const std::string& name, const board::Detection& detection,
                 const BoardPlane& plane);

}  // namespace turnlight::calib::calibrate::handheld
