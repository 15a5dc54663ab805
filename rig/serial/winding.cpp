#include "rig/serial/winding.h"

#include <algorithm>
#include <cmath>

namespace turnlight::rig::serial {
namespace {

// Of decimal angles, as travels are written.
constexpr double kRoundingDeg = 1e-6;

bool Allows(const Travel& travel, double position_deg) {
  return position_deg >= travel.min_deg - kRoundingDeg &&
         position_deg <= travel.max_deg + kRoundingDeg;
}

}  // namespace

std::optional<WoundMove> PlanWoundMove(double angle_deg, double from_angle_deg, int turns,
                                       const std::optional<Travel>& travel, double overshoot_deg) {
  const double position = angle_deg - 360.0 * turns;
  if (!travel || Allows(*travel, position)) return WoundMove{{position}, turns};
  const bool rising = angle_deg >= from_angle_deg;
  const double end = rising ? travel->min_deg - kRoundingDeg : travel->max_deg + kRoundingDeg;
  const int unwound = static_cast<int>(rising ? std::floor((angle_deg - end) / 360.0)
                                              : std::ceil((angle_deg - end) / 360.0));
  const double target = angle_deg - 360.0 * unwound;
  if (!Allows(*travel, target)) return std::nullopt;
  const double past = std::clamp(target + (rising ? -overshoot_deg : overshoot_deg),
                                 travel->min_deg, travel->max_deg);
  return WoundMove{{past, target}, unwound};
}

}  // namespace turnlight::rig::serial
