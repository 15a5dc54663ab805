// The chunks of a PNG, walked before libpng sees them: sizes are checked before memory is taken,
// damage is told by its kind, and the decoder gets no odd chunks. Internal to this folder.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>

#include "base/result.h"
#include "rig/session/image_formats.h"
#include "rig/session/picture_claims.h"

namespace turnlight::rig {

inline constexpr int kPngGrey = 0, kPngRgb = 2, kPngPalette = 3;  // colour types

struct PngChunks {
  std::string pixels;  // a PNG of what makes up the pixels, and nothing else
  int width = 0, height = 0;
  int bits = 8;    // per channel, or of an index
  int colour = 0;  // type
  PictureClaims claims;
};

// Refuses what a picture of this use may not be, and turned ones.
Result<PngChunks> WalkPng(const std::string& bytes, const std::string& file, cv::Size expected,
                          PictureUse use);

}  // namespace turnlight::rig
