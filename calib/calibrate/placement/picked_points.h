// Points that the user has picked: which point of the target is at which pixel of which frame.
#pragma once

#include <filesystem>
#include <vector>

#include "base/result.h"
#include "calib/calibrate/placement/placement.h"

namespace turnlight::calib::calibrate::placement {

// A text file: six numbers a line, separated by commas or spaces: frame (from 0), x, y (pixels, the
// centre of the top-left one is 0, 0), X, Y, Z (in T, length unit). Lines that begin with # and a
// first line of words are passed over. Fails (kInput) with file and line.
Result<std::vector<PickedPoint>> ReadPickedPoints(const std::filesystem::path& path,
                                                  std::size_t frames);

}  // namespace turnlight::calib::calibrate::placement
