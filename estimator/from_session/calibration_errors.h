// From a rig's calibration with its covariances to what it may have wrong, as the estimator takes
// it.
#pragma once

#include <cstddef>
#include <vector>

#include "estimator/calibration_errors.h"
#include "estimator/target/geometry.h"
#include "rig/rig_calibration.h"
#include "rig/session/session.h"

namespace turnlight::estimator::from_session {

// Items: lens, camera-pose, axis, target-place, angle-scale, angle-offset, response; those that the
// calibration has a covariance of. Where the errors of some go together each item has what is
// nearest to it of them (of all whitened parts together, the symmetric square root of their
// correlation), so that squares still add up to the joint variance. frames: the session's that are
// the keyframes, all with the angle of their poses. Calibration, session and geometry are copied or
// used here only. Directions of the lens that move the target's image by less than a hundredth of
// the others together are left out.
CalibrationErrors ErrorsOf(const rig::RigCalibration& calibration, const rig::Session& session,
                           const std::vector<std::size_t>& frames,
                           const target::Geometry& geometry);

}  // namespace turnlight::estimator::from_session
