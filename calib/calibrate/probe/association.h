// Which spot is which light: what several views show of one light that stands still in W.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "calib/calibrate/probe/ball.h"
#include "calib/calibrate/probe/spots.h"

namespace turnlight::calib::calibrate::probe {

struct SpotIndex {
  std::size_t view = 0;
  std::size_t spot = 0;  // of the view
};

// Spots that one light explains, at most one of each view, in order of the views.
using SpotGroup = std::vector<SpotIndex>;

// All spots in groups, each in one: first those that hold most spots that look like lights. A group
// is what a pair of spots of two views proposes, a distant light or the point where the rays pass,
// and all that agree with it within 1.5 degrees. What agrees with nothing is a group by itself.
std::vector<SpotGroup> GroupSpots(const std::vector<BallView>& views,
                                  const std::vector<std::vector<Spot>>& spots);

}  // namespace turnlight::calib::calibrate::probe
