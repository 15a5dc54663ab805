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
  double turn = 0.0;          // radians: how far the mirrored view turns within a pixel
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // W: where it is on the target
};

// The mean of the channels; 0 where a value is not finite.
cv::Mat1f GreyOf(const cv::Mat& radiance);

// The mean of what is inside, weighed by a Gaussian of `sigma` pixels. inside: each pixel's share;
// weight (optional): the Gaussian's share that is inside.
cv::Mat1f MeanInside(const cv::Mat1f& value, const cv::Mat1f& inside, double sigma,
                     cv::Mat1f* weight = nullptr);

// Standard deviation of the noise of a picture's pixels, by the median second difference along
// rows.
double NoiseOf(const cv::Mat1f& grey, const cv::Mat1b& inside);

// The spots of a picture, the clearest first, none within 7 degrees of a clearer one. inside: the
// pixels of the target that can be used, 255 or 0. Bright against a surround 2.5 times as wide, at
// scales from 1 to 8 pixels, and a seventeenth of the target's width at most, of a picture in which
// it is at most 512 pixels wide: by 12 % of the surround and 4 sigma, with a sigma of noise, 1.5 %
// of the surround and 0.1 % of the brightest. The direction is the centroid of what is above the
// surround by 0.3 of the spot's peak. Clipped pixels count as they are.
std::vector<Spot> FindSpots(const model::Keyframe& keyframe, std::size_t index,
                            const cv::Mat1b& inside, const target::Geometry& geometry,
                            const calib::RayGrid& rays);

// Spots that one light makes.
struct SpotCluster {
  Eigen::Vector3d direction;      // from the reference
  double inverse_distance = 0.0;  // 1/R
  double sigmas = 0.0;            // of all spots together
  std::size_t views = 0;
};

// Spots of one light, within 8 degrees as seen from the reference, the clearest first. Lights may
// be near: of some inverse distances, the same for all lights, that is taken with which spots of
// several views make the fewest lights. Spots weigh by what a pixel tells there.
std::vector<SpotCluster> ClusterSpots(const std::vector<Spot>& spots,
                                      const Eigen::Vector3d& reference, double radius);

}  // namespace turnlight::estimator::observe
