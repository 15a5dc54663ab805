// Mosaics of one colour a pixel. Internal to this folder.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "base/result.h"

namespace turnlight::rig {

// RGGB, BGGR, GRBG, GBRG: the colours of the first two pixels of the first two rows.
const std::vector<std::string>& BayerPatterns();

// A mosaic to R, G, B, edge-aware. pattern is one of BayerPatterns. Fails (kInput): image is not of
// one channel, 8 or 16 bits, at least 4 x 4 pixels.
Status Demosaic(const std::string& pattern, const std::string& file, cv::Mat& image);

}  // namespace turnlight::rig
