// The corners of a flat target in pictures, as a person picked them.
//
//   size: [300, 200]         # of the target, width and height, length unit
//   pictures:
//     - {image: a.png, corners: [[612, 340], [1204, 371], [1190, 802], [598, 760]]}
//
// Corners as seen from the front: top left, top right, bottom right, bottom left. Pixel (0, 0) is
// the centre of the top-left pixel.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/document.h"
#include "base/result.h"
#include "calib/calibrate/handheld/registration.h"
#include "calib/target_shape.h"

namespace turnlight::calib::calibrate::handheld {

struct PickedCorners {
  std::string image;  // as the file has it
  std::array<Eigen::Vector2d, 4> pixels;
};
struct CornersFile {
  PlaneShape plane;  // one side
  std::vector<PickedCorners> pictures;
};

// Fails (kInput) with file, line, key and what is allowed.
Result<CornersFile> ReadCorners(const Document& document);

// In the plane's own frame: z = 0, x to the right, y up, origin in the middle, as seen from the
// front.
PlaneView ViewOf(const PickedCorners& corners, const PlaneShape& plane);

}  // namespace turnlight::calib::calibrate::handheld
