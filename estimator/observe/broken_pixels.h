// Pixels whose value is not what the surface sent: found in the picture alone, before any model.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

namespace turnlight::estimator::observe {

enum BrokenPixel : std::uint8_t {
  kImplausible = 1,  // not finite, or 10^4 times what the target's brighter pixels show
  kOutlier = 2,      // unlike its neighbourhood, in a picture that has many such
  kFloored = 4,      // so dark that the sensor's floor cut part of its noise off
};

// One byte of BrokenPixel bits per pixel of the target (mask non-zero); 0 elsewhere. radiance: 1 or
// 3 channels, float.
//
// A highlight may be a single pixel, so pixels that are brighter than all around them say nothing;
// single pixels that are darker than all eight neighbours by more than noise are what no scene
// shows. Only where they are many (0.05 % of the target) is every pixel, dark or bright, taken out
// that is more than 6 robust sigma from the median of the 5 x 5 around it; twice, for outliers hide
// each other.
//
// A sensor without a black level shows noise below 0 as its lowest value. Where that value is
// frequent and scattered, pixels whose neighbourhood is within 2 sigma of it are floored:
// their mean is not the radiance.
cv::Mat1b FindBrokenPixels(const cv::Mat& radiance, const cv::Mat1b& target);

}  // namespace turnlight::estimator::observe
