// A fitted change of a rig as lengths and angles that people know. Internal to this folder.
#pragma once

#include <vector>

#include "calib/calibrate/drift/drift.h"
#include "calib/calibrate/drift/hypothesis.h"

namespace turnlight::calib::calibrate::drift {

// Those of the fit's causes that the pictures tell.
std::vector<Quantity> QuantitiesOf(const HypothesisFit& fit, const rig::RigCalibration& stored);

}  // namespace turnlight::calib::calibrate::drift
