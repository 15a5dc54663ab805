// Lights from what one or several balls show of them in several views, with what they are known to.
//
// Assumed: the lights stand still in W, the balls are spheres of known radius and perfect mirrors
// in shape. Each light is fitted as near, and called near only if its inverse distance is 3 sigma
// from 0, of everything that is known to be uncertain; otherwise as distant.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calib/calibrate/probe/association.h"
#include "calib/calibrate/probe/ball.h"
#include "calib/calibrate/probe/spots.h"

namespace turnlight::calib::calibrate::probe {

// What is uncertain besides the spots: all views with one quantity moved by one sigma.
struct Perturbation {
  std::string item;  // "ball centre", "ball radius", "camera pose", ...; several may share one
  std::vector<BallView> views;
};

struct BudgetItem {
  std::string item;
  double direction_sigma = 0.0;         // radians, at the reference point
  double inverse_distance_sigma = 0.0;  // 1 / length unit; 0 of distant lights
};

// A light as it is known from one cause of errors or from all.
struct LightSigmas {
  double direction = 0.0;  // radians: root of the larger eigenvalue of the tangent covariance
  double inverse_distance = 0.0;  // of near lights
  double distance = 0.0;
};

struct ProbeLight {
  bool near = false;
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  // unit, from W's origin
  double inverse_distance = 0.0;                         // from W's origin; 0: distant
  // Where on the balls it was seen, in W: the mean of the points. There its direction is best
  // known, and known whatever its distance.
  Eigen::Vector3d reference = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction_at_reference = Eigen::Vector3d::UnitZ();
  Eigen::Matrix3d direction_covariance = Eigen::Matrix3d::Zero();  // of the unit vector, in W
  Eigen::Matrix3d reference_covariance = Eigen::Matrix3d::Zero();  // of direction_at_reference
  std::optional<Eigen::Vector3d> position;                         // of near lights, in W
  Eigen::Matrix3d position_covariance = Eigen::Matrix3d::Zero();
  std::optional<double> distance_min;  // 95 % bound, from W's origin; nothing: no bound
  LightSigmas sigma, stat;             // all; spots alone
  std::vector<BudgetItem> budget;
  std::optional<double> intensity, intensity_sigma;  // to the strongest; nothing where clipped
  double irradiance = 0.0;  // at the ball, white of the sensor times steradian; mirror of 1
  bool clipped = false;     // in every view: irradiance is a lower bound
  double extent_deg = 0.0;  // median of the views
  double scatter = 0.0;     // root of chi squared per degree of freedom; 0: one view
  SpotGroup spots;
};

struct ProbeCandidate {
  SpotGroup spots;
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  // unit, of the first spot
  std::string why;
};

struct ProbeLights {
  std::vector<ProbeLight> lights;  // strongest first
  std::vector<ProbeCandidate> candidates;
};

// spots: of each view.
ProbeLights FindLights(const std::vector<BallView>& views,
                       const std::vector<std::vector<Spot>>& spots,
                       const std::vector<Perturbation>& perturbations);

}  // namespace turnlight::calib::calibrate::probe
