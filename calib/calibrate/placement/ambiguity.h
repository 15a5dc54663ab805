// What outlines cannot tell, and what the user should know of a fit. Internal to this folder.
#pragma once

#include <vector>

#include "calib/calibrate/placement/fit.h"

namespace turnlight::calib::calibrate::placement {

// A plain rectangle looks the same turned by half a turn (a square by a quarter): of these
// placements the one whose x axis is nearest to A's is taken, unless points were picked. A mesh
// that looks the same however it is turned about an axis gets that axis, and the rotation about it
// a variance of pi^2 / 3, that of an angle of which nothing is known.
void ResolveAmbiguity(const Problem& problem, const Fit& fit, const calib::TargetShape& shape,
                      bool picked, Placement& placement);

void AddRemarks(const calib::TargetShape& shape, const std::vector<View>& views,
                const PlacementOptions& options, Placement& placement);

}  // namespace turnlight::calib::calibrate::placement
