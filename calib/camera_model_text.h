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
  std::string lens_model;           // by its name of today, not yet checked
  std::vector<double> intrinsics;   // finite
  std::vector<double> imager_size;  // two numbers, finite, not yet checked
};

// The keys have the names that mrcal gave them over time. The lens model is 'lensmodel', or where
// that is missing 'distortion_model', else 'lens_model'; DISTORTION in its name is read as
// LENSMODEL, and DISTORTION_NONE as LENSMODEL_PINHOLE. The extrinsics are 'extrinsics' or
// 'rt_cam_ref' (from mrcal 2.5 on), or both.
//
// Fails (kInput) with file, line and key: a text of more than kMaxCameraModelBytes, a syntax error,
// a key of these, of 'intrinsics' or 'imagersize' that is missing under all its names or there
// twice, a number that is not finite. Other keys are skipped, as mrcal does; so are the extrinsics,
// which must be there for mrcal's sake.
Result<CameraModelText> ReadCameraModelText(std::string_view text, const std::string& file);

}  // namespace turnlight::calib
