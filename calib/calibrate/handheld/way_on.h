// Where a person who carries the camera should go on to.
#pragma once

#include <string>

#include "calib/calibrate/handheld/view_change.h"
#include "calib/pose.h"

namespace turnlight::calib::calibrate::handheld {

// The shortest way round the target to a view that is a keyframe: "to the left", "to the right",
// "up" or "down" as the camera sees it, or "on, to where none was taken yet" if no such way leads
// to one. X_TC: the camera, away from T's origin. Views from lower than 20 degrees above the board
// are no way: there a board is hardly seen. up_T: out of the board's printed side, a unit vector in
// T.
std::string WayOn(const ViewChange& keyframes, const Pose& X_TC, const Eigen::Vector3d& up_T);

}  // namespace turnlight::calib::calibrate::handheld
