// A TIFF's samples as bytes to a picture's values. Internal to this folder.
#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "base/result.h"
#include "rig/session/tiff_layout.h"

namespace turnlight::rig {

// Where samples go: count pixels from (x, y) on in a row of the picture, into `channels` channels
// from `channel` on.
struct TiffPlace {
  int x = 0, y = 0, count = 0, channel = 0, channels = 1;
};

// bytes: count * channels samples as libtiff hands them out, in the machine's byte order, those of
// fewer than 8 bits or of 9 to 15 packed from the highest bit on. Fails (kInput) at a whole number
// that the picture's 32-bit float cannot hold; file names it in messages.
Status StoreSamples(const TiffLayout& layout, const unsigned char* bytes, const TiffPlace& place,
                    const std::string& file, cv::Mat& image);

// Indices of a palette to 255 where its colour is not black; values whose white is 0, turned round.
// image: of a mask, as StoreSamples left it.
void ResolveMask(TIFF* tiff, const TiffLayout& layout, cv::Mat& image);

// CIE XYZ, as LogLuv is decoded, to linear R, G, B of the primaries of sRGB.
void ResolveLogLuv(cv::Mat& image);

}  // namespace turnlight::rig
