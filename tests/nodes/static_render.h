// What a picture must look like if the table stood still at the commanded angle, computed here from
// the scene alone: the pose by its formula, the noise by the sensor's figures. Shares the renderer
// with the simulated camera, and nothing of what decides when and at which angle that one exposes.
#pragma once

#include <vector>

#include "nodes/messages.h"
#include "rig/sim/mock_camera.h"

namespace turnlight::nodes {

// The largest |picture - static render| over all pixels, channels and brackets, each in standard
// deviations of that value's noise. Linear 16-bit pictures without shot noise only.
double WorstSigmas(const std::vector<Bracket>& brackets, const rig::sim::MockCameraConfig& config);

}  // namespace turnlight::nodes
