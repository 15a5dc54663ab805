// What a calibrated rig is good for, part by part, for a person and as JSON; of a simulated rig
// beside its truth.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "app/calibrate/rig_steps.h"
#include "app/simulator.h"
#include "base/result.h"
#include "estimator/model/scene.h"

namespace turnlight::app {

// What is true of a simulated rig in the frame W that a calibration chooses (the axis, the camera's
// half-plane y = 0; see docs/design.md, "The rig's calibration on disk").
struct TrueRig {
  rig::RigCalibration calibration;
  estimator::model::Scene scene;
};
Result<TrueRig> TruthOf(const SimulatorConfig& simulator);

struct RigFindings {
  std::optional<calib::calibrate::response::Response> response;
  const LensFound& lens;
  const AxisFound& axis;
  const TargetFound& target;
};

// summary.json's object: of each part its figures with sigmas, and its error where there is a
// truth.
nlohmann::ordered_json SummaryOf(const RigFindings& found, const std::optional<TrueRig>& truth);
// Adds the lights of a result.json: direction, sigma, the calibration's share, error.
Status AddLights(const std::filesystem::path& result, const std::optional<TrueRig>& truth,
                 nlohmann::ordered_json& summary);
// Lines, each ended.
std::string SummaryText(const nlohmann::ordered_json& summary);

}  // namespace turnlight::app
