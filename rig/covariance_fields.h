// Covariances in rig-calibration.json. Internal to this folder.
#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/result.h"
#include "base/strict_object.h"
#include "rig/rig_calibration.h"

namespace turnlight::rig {

// The key covariance, size x size; nothing if it is not there. Refusals stay in the object.
std::optional<Eigen::MatrixXd> ReadCovariance(StrictObject& object, Eigen::Index size);
void AddCovariance(nlohmann::ordered_json& object,
                   const std::optional<Eigen::MatrixXd>& covariance);

// The key joint_covariance: of parts that have a covariance of their own, which it repeats.
Result<JointCovariance> ReadJointCovariance(StrictObject object,
                                            const CalibrationCovariances& known);
nlohmann::ordered_json PrintJointCovariance(const JointCovariance& joint);

}  // namespace turnlight::rig
