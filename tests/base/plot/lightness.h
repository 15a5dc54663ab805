// How light a colour looks.
#pragma once

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace turnlight::plot {

// CIE L* of a display colour.
inline double Lightness(const cv::Vec3b& colour) {
  cv::Mat3f pixel(1, 1, cv::Vec3f(colour) / 255.0f);
  cv::cvtColor(pixel, pixel, cv::COLOR_RGB2Lab);
  return pixel(0, 0)[0];
}

}  // namespace turnlight::plot
