#include "rig/session/mosaic.h"

#include <opencv2/imgproc.hpp>

namespace turnlight::rig {
namespace {

int DemosaicCode(const std::string& pattern) {
  if (pattern == "RGGB") return cv::COLOR_BayerRGGB2RGB_EA;
  if (pattern == "BGGR") return cv::COLOR_BayerBGGR2RGB_EA;
  if (pattern == "GRBG") return cv::COLOR_BayerGRBG2RGB_EA;
  return cv::COLOR_BayerGBRG2RGB_EA;
}

}  // namespace

const std::vector<std::string>& BayerPatterns() {
  static const std::vector<std::string> kPatterns{"RGGB", "BGGR", "GRBG", "GBRG"};
  return kPatterns;
}

Status Demosaic(const std::string& pattern, const std::string& file, cv::Mat& image) {
  if (image.channels() != 1 || image.depth() == CV_32F || image.rows < 4 || image.cols < 4)
    return InputError(file + ": radiometry/bayer is " + pattern +
                      ", which needs pictures of 1 channel, 8 or 16 bits and 4 x 4 pixels or more");
  cv::Mat colour;
  cv::demosaicing(image, colour, DemosaicCode(pattern));
  image = colour;
  return {};
}

}  // namespace turnlight::rig
