// A map of all directions: azimuth across, zenith angle down, with marks and a list of them.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace turnlight::plot {

struct SkyMark {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  // unit
  double radius = 0.0;  // radians, of the circle about it; drawn if larger than a pixel of the map
  std::string label;    // beside its ring: a number
  std::string words;    // a line of the list below the map
};

struct SkyText {
  std::string title;
  std::string unit;  // of the map's values
};

// "azimuth 30.00 deg,  zenith 40.00 deg", with the sign for degrees.
std::string SkyAngles(const Eigen::Vector3d& direction);

// map: values by direction, azimuth 0..360 degrees over the columns, zenith 0..180 over the rows;
// NaN where nothing was seen. Gaps of a cell or two are closed.
cv::Mat3b SkyMap(const cv::Mat1f& map, const SkyText& text, const std::vector<SkyMark>& marks);

}  // namespace turnlight::plot
