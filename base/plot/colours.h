// Colours of the pictures: display encoding and colour maps. All colours are R, G, B.
#pragma once

#include <opencv2/core.hpp>

namespace turnlight::plot {

inline const cv::Vec3b kPaper(255, 255, 255);
inline const cv::Vec3b kInk(45, 45, 45);
inline const cv::Vec3b kFaint(215, 215, 215);       // grids and frames
inline const cv::Vec3b kUnobserved(150, 150, 150);  // no value, in a diverging map
inline const cv::Vec3b kUnseen(78, 78, 78);         // no value, in a sequential map

// Blue, white, red for t in [-1, 1], limited to it; equal steps look equal and -t is as light as t.
// NaN gives kUnobserved.
cv::Vec3b DivergingColour(double t);

// From near black over violet and orange to light yellow (the map "inferno") for t in [0, 1],
// limited to it. NaN gives kUnseen.
cv::Vec3b SequentialColour(double t);

// Radiance times exposure to the sRGB encoding, enlarged by a whole factor. What lies outside
// [0, 1] is limited; what is not finite is black.
cv::Mat3b ToDisplay(const cv::Mat3f& radiance, double exposure, int enlarge);

}  // namespace turnlight::plot
