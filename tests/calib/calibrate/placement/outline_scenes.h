// Rigs and outlines with noise, for the tests of placements.
#pragma once

#include <cstdint>
#include <vector>

#include "base/random.h"
#include "calib/calibrate/placement/placement.h"

namespace turnlight::calib::calibrate::placement {

// 1280 x 960, f = 2000 px, mild distortion, 400 mm from the axis, 35 degrees above; the axis leans
// a little, and the table's angles have scale and offset.
rig::RigCalibration SampleRig();

// A lump without symmetry, some 35 mm in radius; and a turned body about z.
calib::MeshShape Lump();
calib::MeshShape Vase();

// Anywhere within 15 mm of the axis; turned about it by any angle and leant by up to 15 degrees.
calib::Pose RandomPlace(const RandomStream& random, double lean_deg = 15.0);

struct OutlineNoise {
  double sigma = 0.3;        // pixels
  double correlation = 0.0;  // of neighbours, 0..1: a first-order chain
  double angle_sigma_deg = 0.0;
};
std::vector<View> Outlines(const rig::RigCalibration& rig, const calib::TargetShape& shape,
                           const calib::Pose& X_AT, const std::vector<double>& angles_deg,
                           const OutlineNoise& noise, std::uint64_t seed);

// Five vertices as the first view (angle 0) shows them, off by sigma pixels along each axis.
std::vector<PickedPoint> Pick(const rig::RigCalibration& rig, const calib::MeshShape& mesh,
                              const calib::Pose& X_AT, double sigma, std::uint64_t seed = 9);

std::vector<double> Revolution(int views);

// (w, d) from the estimate to the truth, in A.
Eigen::Matrix<double, 6, 1> ErrorOf(const calib::Pose& estimate, const calib::Pose& truth);

}  // namespace turnlight::calib::calibrate::placement
