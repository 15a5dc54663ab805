// JPEG photographs, which people calibrate with and carry cameras round targets with. Sessions hold
// none: their pictures are without further loss.
#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "base/result.h"

namespace turnlight::rig {

enum class JpegChannels {
  kGrey,      // the file's brightness channel, or that of its R, G, B
  kAsStored,  // grey, or R, G, B
};

struct JpegPicture {
  cv::Mat image;  // CV_8U
  int orientation =
      1;  // of EXIF, 1 to 8: how to turn the picture for the eye; 1 if it says nothing
};

// Rows and columns are those of the sensor: the picture is not turned. `file` names it in messages.
// Fails (kInput): not a JPEG file, damaged or truncated, more than 2^28 pixels, more than 100
// passes, neither grey nor colour of three channels, more than 8 bits.
Result<JpegPicture> DecodeJpeg(const std::string& bytes, const std::string& file,
                               JpegChannels channels = JpegChannels::kGrey);

}  // namespace turnlight::rig
