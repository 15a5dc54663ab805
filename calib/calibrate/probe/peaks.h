// Peaks of a map, each with how far down it stands by itself. Internal to spots.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace turnlight::calib::calibrate::probe {

struct Peak {
  cv::Point at;
  float height = 0.0f;
  float saddle = 0.0f;  // the highest level at which it meets another peak; 0: none
};

// Pixels of the region whose value is above `floor` are flooded from the top. A peak that meets a
// higher one counts if it stands at least `depth` of its own height, and `depth_min`, above their
// saddle. 8-connected. Highest first; of equal values the first in reading order.
std::vector<Peak> FindPeaks(const cv::Mat1f& map, const cv::Mat1b& region, float floor, float depth,
                            float depth_min);

// The pixels connected to the start whose value is at least level, as 255.
cv::Mat1b FloodFrom(const cv::Mat1f& map, const cv::Mat1b& region, cv::Point start, float level);

}  // namespace turnlight::calib::calibrate::probe
