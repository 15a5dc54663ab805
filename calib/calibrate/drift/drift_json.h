// check.json version 1: a check of a calibration for programs. README.md has its keys.
#pragma once

#include <string>

#include "calib/calibrate/drift/drift.h"

namespace turnlight::calib::calibrate::drift {

std::string PrintDrift(const DriftReport& report);

}  // namespace turnlight::calib::calibrate::drift
