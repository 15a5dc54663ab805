// Highlights as evidence of lights: compact bright spots that shading cannot make. In a mirror's
// place on the target a light shows at its mirrored direction, whatever the rest of the surface
// does; this is the first step of the published method, made to find every light.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <opencv2/core.hpp>
#include <vector>

#include "calib/camera_model.h"
#include "estimator/model/keyframe.h"
#include "estimator/target/geometry.h"

namespace turnlight::estimator::observe {

struct Spot {
  std::size_t keyframe = 0;
  Eigen::Vector3d direction;  // W, unit: of the light that would make it, by the mirrored view
  double contrast = 0.0;      // its mean above its surround, of the surround
  double sigmas = 0.0;        // the same, of what texture and noise make
};

// The mean of the channels; 0 where a value is not finite.
cv::Mat1f GreyOf(const cv::Mat& radiance);

// The spots of a picture, the clearest first, none within 7 degrees of a clearer one. inside: the
// pixels of the target that can be used, 255 or 0. Bright against a surround 2.5 times as wide, at
// scales from 1 to 8 pixels of a picture in which the target is at most 512 pixels wide: by 12 % of
// the surround and 4 sigma, with a sigma of 1.5 % of the surround and 0.1 % of the brightest. The
// direction is the centroid of what is above the surround by 0.3 of the spot's peak. Clipped pixels
// count as they are.
std::vector<Spot> FindSpots(const model::Keyframe& keyframe, std::size_t index,
                            const cv::Mat1b& inside, const target::Geometry& geometry,
                            const calib::RayGrid& rays);

// A direction in which several pictures have a spot.
struct SpotCluster {
  Eigen::Vector3d direction;
  double sigmas = 0.0;  // of all spots together
  std::size_t views = 0;
};

// Spots of one light, within 8 degrees, the clearest first.
std::vector<SpotCluster> ClusterSpots(const std::vector<Spot>& spots);

}  // namespace turnlight::estimator::observe
