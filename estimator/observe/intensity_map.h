// The intensity map: what is seen in each mirrored direction, over all views (paper, section 3.2).
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

#include "estimator/observe/observations.h"

namespace turnlight::estimator::observe {

// Grey intensity (of white) by direction: rows are the zenith about W's +z (0..180 degrees),
// columns the azimuth (0..360 degrees), one degree a cell; NaN where nothing was seen.
struct IntensityMap {
  cv::Mat1f intensity;
};

// The paper's high-intensity areas and their clusters: share of the map's range, and the radius of
// leader clustering (section 3.2).
inline constexpr double kHighShare = 0.5;
inline constexpr double kClusterRadiusDeg = 25.0;

// Every pixel's grey value is plotted at the direction of its mirrored view; a cell is the mean.
// Then a Gaussian of 2 degrees on the sphere (wide enough to close the gaps between samples).
IntensityMap MakeIntensityMap(const Observations& observations);

// The direction in W at the middle of a cell.
Eigen::Vector3d MapDirection(int row, int column);

// A direction in W and the map's value there.
struct MapPoint {
  Eigen::Vector3d direction;
  double intensity;
};

// The cells at or above share of the way from the map's darkest to its brightest, brightest first.
std::vector<MapPoint> HighIntensityArea(const IntensityMap& map, double share);

// Leader clustering (Kirmse et al., 2011): in the order given, a point joins the first cluster
// whose leader is within radius (radians), else it founds one. Returns the leaders: of points that
// come brightest first, the brightest of each cluster.
std::vector<MapPoint> LeaderClustering(const std::vector<MapPoint>& points, double radius);

}  // namespace turnlight::estimator::observe
