// What a picture must look like if the table stood still at the commanded angle, computed here from
// the scene alone: the pose by its formula, the noise by the sensor's figures. Shares the renderer
// with the simulated cameras, and nothing of what decides when and at which angle those expose.
#pragma once

#include <vector>

#include "nodes/messages.h"
#include "rig/sim/mock_camera.h"
#include "rig/sim/studio.h"

namespace turnlight::nodes {

// Of linear pictures whose black is 0. Of one channel: grey, the mean of the scene's three, or a
// mosaic.
struct PictureKind {
  int bits = 16;        // of a value: white is 2^bits - 1
  bool mosaic = false;  // R G in the even rows, G B in the odd ones
};

class StaticScene {
 public:
  // Throws what cannot be built.
  explicit StaticScene(const rig::sim::MockCameraConfig& config, const PictureKind& kind = {});

  // The largest |picture - static render at the bracket's angle| over all pixels, channels and
  // exposures, each in standard deviations of that value's noise and of rounding to whole DN.
  double WorstSigmas(const Bracket& bracket) const;

 private:
  const rig::sim::MockCameraConfig config_;
  const PictureKind kind_;
  const rig::sim::Studio studio_;
};

// The largest of all brackets, of pictures of the default kind.
double WorstSigmas(const std::vector<Bracket>& brackets, const rig::sim::MockCameraConfig& config);

}  // namespace turnlight::nodes
