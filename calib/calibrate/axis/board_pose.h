// Where a board may be, from one view of it: a first guess.
#pragma once

#include <vector>

#include "calib/calibrate/board/board.h"
#include "calib/camera_model.h"
#include "calib/pose.h"

namespace turnlight::calib::calibrate::axis {

struct BoardPoses {
  // X_CB, the best first; a second one where the picture of a small or distant board fits two
  // tilts. Empty if the view is of no use.
  std::vector<Pose> X_CB;
  std::vector<bool> fits;  // by place in the view: not far off
};

// From rays and a homography (Collins and Bartoli's IPPE), leaving out points that lie far off.
BoardPoses GuessBoardPoses(const board::Board& board, const CameraModel& camera,
                           const board::BoardView& view);

}  // namespace turnlight::calib::calibrate::axis
