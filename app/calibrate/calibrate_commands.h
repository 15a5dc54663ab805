// turnlight calibrate PART: each part declares itself below `calibrate`, as a command of its own
// does below the program.
#pragma once

#include <CLI/CLI.hpp>

#include "app/command.h"

namespace turnlight::app {

void AddCalibrateLights(CLI::App& calibrate, Action& action);

}  // namespace turnlight::app
