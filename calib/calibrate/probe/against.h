// The ball's lights against those of an estimate, or of anything that says where lights are: do
// they agree within their sigmas?
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "calib/calibrate/probe/lights.h"

namespace turnlight::calib::calibrate::probe {

struct StatedLight {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  // unit, from W's origin
  double direction_sigma = 0.0;                          // radians; 0: stated without error
  std::optional<Eigen::Vector3d> position;
  std::optional<Eigen::Matrix3d> position_covariance;
  std::optional<double> distance, distance_sigma, distance_min;  // from W's origin
};

// The lights of a result.json, a lights.json, or a truth.json (any file with a list `lights` of
// objects with a direction; position, direction_sigma_deg, distance, distance_sigma, distance_min
// and position_covariance may be there; other keys are passed over). file is only for messages.
// Fails (kInput): a syntax error, no list, a direction without length, a number of the wrong kind.
Result<std::vector<StatedLight>> ReadStatedLights(const std::string& text, const std::string& file);

struct LightAgreement {
  std::optional<std::size_t> light, stated;  // one of them is missing if nothing is there for it
  double angle = 0.0;                        // radians, as seen from the light's reference point
  double angle_sigmas = 0.0;                 // of both sides
  std::optional<double> distance, distance_sigmas;  // stated less the ball's, where both know it
  bool agrees = false;
  std::string words;
};

struct Agreement {
  std::vector<LightAgreement> lights;
  bool agrees = true;
};

// Partners are those of the least sum of angles, greedily from the smallest; more than 15 degrees
// apart are none. They agree within 3 sigmas of angle and, where both know it, of distance; where
// one side only has a bound, the other's distance must not be below it by more than 3 sigmas.
Agreement CompareLights(const std::vector<ProbeLight>& lights,
                        const std::vector<StatedLight>& stated, const std::string& length_unit);

}  // namespace turnlight::calib::calibrate::probe
