// Reads the text of a .cameramodel file: a Python dictionary literal, as mrcal writes it.
//
// mrcal's own reader prints to standard error, tells nothing to its caller, and depends on the
// locale; this one reads the same files and says what is wrong, and where.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace turnlight::calib {

// Calibrations carry their measurements along in a long text, so some megabytes are usual.
inline constexpr std::size_t kMaxCameraModelBytes = std::size_t{64} << 20;

struct CameraModelText {
  std::string lens_model;           // as written, not yet checked
  std::vector<double> intrinsics;   // finite
  std::vector<double> imager_size;  // two numbers, finite, not yet checked
};

// Fails (kInput) with file, line and key: a text of more than kMaxCameraModelBytes, a syntax error,
// a missing or repeated key of 'lensmodel', 'intrinsics', 'extrinsics', 'imagersize', a number that
// is not finite. Other keys are skipped, as mrcal does; so are the extrinsics, which must be there
// for mrcal's sake.
Result<CameraModelText> ReadCameraModelText(std::string_view text, const std::string& file);

}  // namespace turnlight::calib
