// A page with the sensor on it, for maps and arrows.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "base/plot/chart.h"
#include "calib/calibrate/lens/projection_difference.h"

namespace turnlight::calib::calibrate::lens {

struct SensorPage {
  cv::Mat3b page;
  cv::Rect area;       // of the page, that shows the sensor
  double scale = 1.0;  // page pixels a sensor pixel

  cv::Point2d ToPage(const Eigen::Vector2d& pixel) const {
    return {area.x + (pixel.x() + 0.5) * scale - 0.5, area.y + (pixel.y() + 0.5) * scale - 0.5};
  }
};

// An empty sensor with its pixels as axes, a title above and a line of words below; room for a
// colour bar at its right if wanted.
SensorPage MakeSensorPage(int width, int height, const std::string& title, const std::string& below,
                          bool bar);

// A map of positive values at the grid's pixels on a logarithmic scale, with its bar. NaN is grey.
void DrawLogMap(SensorPage& sensor, const ImageGrid& grid, const std::vector<double>& values,
                const std::string& unit);

}  // namespace turnlight::calib::calibrate::lens
