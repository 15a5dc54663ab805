// How a TIFF's pixels are laid out, and which of its pages they are. Internal to this folder.
#pragma once

#include <tiffio.h>

#include <cstdint>
#include <string>
#include <vector>

#include "base/result.h"
#include "rig/session/image_formats.h"

namespace turnlight::rig {

enum class TiffSample { kUnsigned, kSigned, kFloat, kLogLuv, kLogL };

struct TiffLayout {
  std::uint32_t width = 0, height = 0;
  int bits = 8;  // per sample, as libtiff hands them out
  TiffSample sample = TiffSample::kUnsigned;
  int channels = 1;       // per pixel; of masks, alpha is the last of 2 or 4
  int depth = 0;          // of the picture: CV_8U, CV_16U or CV_32F
  bool planes = false;    // channels one after the other
  bool inverted = false;  // masks only: white is 0
  bool palette = false;   // masks only
  std::vector<std::string> remarks;

  bool operator==(const TiffLayout&) const = default;
};

// Of the current page. Refuses what a picture of this use may not be, and turned ones.
Result<TiffLayout> LayoutOfPage(TIFF* tiff, const std::string& file, PictureUse use);

// The pages that are the picture: one, or three which the file says are R, G, B. Thumbnails and
// masks of other pages do not count. Refuses more, and none.
Result<std::vector<tdir_t>> PagesOfPicture(TIFF* tiff, const std::string& file);

}  // namespace turnlight::rig
