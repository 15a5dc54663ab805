// How a fit answers to the errors of a calibration: for each of their directions the pixels of a
// sample are seen once more with the calibration moved to both sides, and the change of the cost's
// gradient says how the unknowns follow, to first order.
#pragma once

#include <cstddef>
#include <optional>

#include "base/result.h"
#include "base/stop_flag.h"
#include "calib/camera_model.h"
#include "estimator/calibration_errors.h"
#include "estimator/observe/observations.h"
#include "estimator/solve/solver.h"
#include "estimator/target/geometry.h"
#include "estimator/uncertainty/budget.h"

namespace turnlight::estimator {

struct CalibratedView {
  std::size_t keyframes;  // how many
  const target::Geometry& geometry;
  const calib::RayGrid& rays;
};

// all: of so many keyframes. A direction is followed for one sigma, or for less if a tenth of the
// pixels would lose the surface. Nothing if there are no items. Fails as errors.move's radiance
// does, and with kInterrupted when stop was set. Deterministic for any number of threads.
Result<std::optional<uncertainty::CalibrationResponse>> RespondToCalibration(
    const CalibratedView& view, const observe::Observations& all, const solve::Solution& solution,
    const CalibrationErrors& errors, const StopFlag* stop);

}  // namespace turnlight::estimator
