// Compact bright spots that a ball shows: the mirror images of lamps.
//
// What is broad is taken off first: an opening of the picture by a square of a fifth of the ball's
// radius leaves the shading, the room and large windows, and takes off what is smaller. Spots are
// the peaks of the rest, each as far down as it is by itself. Near the outline nothing counts:
// there every pixel sees a large part of the room, and the background.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "calib/calibrate/probe/ball.h"
#include "calib/radiometry.h"

namespace turnlight::calib::calibrate::probe {

// How a spot is looked at: as a light, or as what may be one.
enum class SpotKind { kLight, kCandidate };

struct Spot {
  SpotKind kind = SpotKind::kCandidate;
  std::string why;  // of a candidate: why it is not called a light
  // The image point whose mirrored direction is the spot's centre of gravity as a patch of
  // directions, not of pixels: on a curved mirror the two differ.
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  Eigen::Matrix2d noise_covariance = Eigen::Matrix2d::Zero();  // pixel^2, from the picture's noise
  // pixel^2, of what is the same in every picture of this spot at this place: sampling, clipping,
  // lopsidedness, and how much of its size is the lens's blur.
  Eigen::Matrix2d shape_covariance = Eigen::Matrix2d::Zero();
  double peak = 0.0;        // radiance above the ground
  double ground = 0.0;      // radiance around it
  double noise = 0.0;       // sigma of a pixel's radiance
  double area_px = 0.0;     // at half height
  double extent_deg = 0.0;  // full width of the longer axis, as of an evenly lit ellipse
  double irradiance = 0.0;  // at the ball, from the patch: radiance times solid angle, mirror of 1
  double cosine = 0.0;      // MirrorAt's
  bool clipped = false;     // its peak and irradiance are lower bounds
};

struct SpotsFound {
  std::vector<Spot> spots;  // lights first, each kind by irradiance
  double noise = 0.0;       // sigma of a pixel's radiance
  bool ball_seen = false;   // whether enough of the ball is in the picture to look for spots
  // Share of the ball that is clipped without being a spot: windows, or too long an exposure.
  double clipped_share = 0.0;
};

// picture: linear radiance and what is clipped. mask: 0 where the ball is hidden or the pixel is
// not of it; empty: nothing is. Holes of the mask are filled: thresholds leave some at highlights.
SpotsFound FindSpots(const LinearImage& picture, const cv::Mat1b& mask, const BallView& view);

}  // namespace turnlight::calib::calibrate::probe
