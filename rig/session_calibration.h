// The rig's calibration that a session keeps a copy of, if it is indeed the session's.
#pragma once

#include <optional>

#include "base/result.h"
#include "rig/rig_calibration.h"
#include "rig/session/session.h"

namespace turnlight::rig {

// The angle that a frame's poses were made for: the measured one, else the commanded.
std::optional<double> PoseAngleDeg(const FrameRecord& frame);

// Nothing if the session names none. Fails (kInput) with what differs: the file's checksum, what
// ReadRigCalibration refuses, its lens and the session's camera, its length unit, the pose of a
// frame and that of the calibration at the frame's angle.
Result<std::optional<RigCalibration>> ReadSessionCalibration(const Session& session);

}  // namespace turnlight::rig
