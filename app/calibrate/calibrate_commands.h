// turnlight calibrate PART: each part declares itself below `calibrate`, as a command of its own
// does below the program.
#pragma once

#include <CLI/CLI.hpp>

#include "app/command.h"

namespace turnlight::app {

// One line for each part.
void AddCalibrateAxis(CLI::App& calibrate, Action& action);
void AddCalibrateCapture(CLI::App& calibrate, Action& action);
void AddCalibrateCheck(CLI::App& calibrate, Action& action);
void AddCalibrateIntrinsics(CLI::App& calibrate, Action& action);
void AddCalibrateResponse(CLI::App& calibrate, Action& action);
void AddCalibrateRig(CLI::App& calibrate, Action& action);
void AddCalibrateTarget(CLI::App& calibrate, Action& action);
void AddCalibrateLights(CLI::App& calibrate, Action& action);

}  // namespace turnlight::app
