// A simulated person who carries the camera round a still target that stands at a board: in a
// simulation's section `walk`, beside `motion` of the kind orbit, which gives distance and
// elevation. There is no table then.
//
// W is the frame in the middle of the board's points, as calib::calibrate::board::PoseInMiddle has
// it; the camera goes counter-clockwise round its z axis, step by step, and stands still once in
// each. How high it is held, how far away and how level is drawn by the seed and smooth.
//
// Keys: board (as in a section prop), and as the members, all optional.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "base/result.h"
#include "base/strict_object.h"
#include "calib/calibrate/board/board.h"
#include "calib/pose.h"
#include "calib/rig_geometry.h"
#include "rig/device.h"
#include "rig/sim/prop.h"

namespace turnlight::rig::sim {

struct Walk {
  calib::calibrate::board::Board board;
  BoardLook look;
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  // the target's origin in W
  double turn_deg = 0.0;                         // the target about W's z, -360..360
  std::uint64_t seed = 1;
  double speed_deg_s = 6.0;     // round the target, over many steps; above 0, at most 360
  double step_s = 1.0;          // above 0, at most 60
  double sway_deg = 4.0;        // of the elevation, up and down at most, 0..45
  double distance_share = 0.1;  // of the distance, to and fro at most, 0..0.5
  double roll_deg = 5.0;        // at most, 0..90
};

Result<Walk> ReadWalk(StrictObject object);

// How far it has gone round since the start, in degrees; never back.
double WalkedDeg(const Walk& walk, DeviceTime time);

// X_WC and X_WT when it has gone that far.
calib::RigPoses PosesOf(const Walk& walk, const calib::OrbitGeometry& orbit, double walked_deg);

}  // namespace turnlight::rig::sim
