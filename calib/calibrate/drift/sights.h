// What the pictures taken now show of something on the table, as residuals of a rig's calibration.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/result.h"
#include "calib/calibrate/axis/calibrate_axis.h"
#include "calib/calibrate/board/board.h"
#include "calib/calibrate/placement/residuals.h"
#include "calib/target_shape.h"
#include "rig/rig_calibration.h"

namespace turnlight::calib::calibrate::drift {

struct Sights {
  explicit Sights(const rig::RigCalibration& stored) : start(stored) {}

  // Views with something to see in them, their angles as the table reports them.
  std::vector<placement::View> views;
  // Of a rig whose X_AT is the object's pose, its table being at these angles; as many and in the
  // same order each time.
  using Residuals = std::function<std::vector<placement::Residual>(
      const rig::RigCalibration& rig, const std::vector<placement::View>& views,
      double edge_offset)>;
  Residuals residuals;
  rig::RigCalibration start;          // the stored calibration, with X_AT of the object
  bool object_free = false;           // a board lies anywhere
  bool edges = false;                 // outlines, which have an edge offset
  double reach = 0.0;                 // pixels: what a point that finds no outline counts as off
  std::vector<std::string> left_out;  // "view 2 (30 deg): no board was found"
};

// The board's pose is guessed, and its numbering in each view found, with the stored calibration.
Result<Sights> SightsOfBoard(const rig::RigCalibration& calibration, const board::Board& board,
                             const std::vector<axis::AxisView>& views);
// Thinned to a number that is enough.
Result<Sights> SightsOfOutlines(const rig::RigCalibration& calibration, const TargetShape& shape,
                                const std::vector<placement::View>& views);

}  // namespace turnlight::calib::calibrate::drift
