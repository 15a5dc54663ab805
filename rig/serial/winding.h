// Where to send a stage of limited travel for an angle that lies beyond it: a turntable stands
// alike at an angle and a whole turn away from it.
#pragma once

#include <optional>
#include <vector>

namespace turnlight::rig::serial {

struct Travel {
  double min_deg = 0.0, max_deg = 0.0;
};

// Positions of the controller to command, one after the other, and the turns to add to what it
// reports to get the angle: angle = position + 360 * turns.
struct WoundMove {
  std::vector<double> legs_deg;
  int turns = 0;
};

// With the turns kept if the travel allows; else with those that bring the position furthest back
// against the direction of motion, so that the most turning is left ahead. A stage that unwinds
// comes from the other side: it goes past the target by overshoot_deg first (less at the end of its
// travel), so that it arrives the way it went before. No travel: turns without an end. Nothing: no
// whole turn brings the angle within the travel.
std::optional<WoundMove> PlanWoundMove(double angle_deg, double from_angle_deg, int turns,
                                       const std::optional<Travel>& travel, double overshoot_deg);

}  // namespace turnlight::rig::serial
