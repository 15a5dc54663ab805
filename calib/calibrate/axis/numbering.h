// Which numbering and which tilt of each view's board is consistent with the angles that the table
// reports: a chessboard looks the same from several sides, and a small picture of one fits two
// tilts.
#pragma once

#include <cstddef>
#include <vector>

#include "base/result.h"
#include "calib/pose.h"

namespace turnlight::calib::calibrate::axis {

struct TurningView {
  double angle_deg = 0.0;  // as the table reports it
  std::vector<Pose> X_CB;  // the tilts that fit, at least one
};

struct TurningBoard {
  Eigen::Vector3d direction_C;  // unit; the board turns about it by scale times the angle
  double scale = 1.0;           // above 0 about this direction
  struct Choice {
    std::size_t turn = 0, tilt = 0;
    double turned = 0.0;   // radians from view `reference`
    double off_deg = 0.0;  // rotation between the board as it is seen and as it should be
    bool fits = false;
  };
  std::vector<Choice> choices;  // of each view
  std::size_t reference = 0;
};

// The candidates, the best first; several where the board looks nearly the same turning about other
// axes: from the other side, or with all tilts mirrored. turns: the board in frame B' is where it
// would be numbered otherwise, X_CB' = X_CB X_BB'; the first is the identity. The reference view
// keeps its numbering: which corner is point 0 is a choice. Fails (kNoEstimate): no axis that more
// than half of the views turn about.
Result<std::vector<TurningBoard>> FindTurning(const std::vector<TurningView>& views,
                                              const std::vector<Pose>& turns);

}  // namespace turnlight::calib::calibrate::axis
