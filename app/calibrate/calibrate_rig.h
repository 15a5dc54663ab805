// What `turnlight calibrate rig` does: from an unpacked camera to lights, in steps that are kept.
//
//   OUT/config.yaml            the config as it was read; another one is refused
//   OUT/response, lens, axis, target   each with its capture.json and pictures, and what was found
//   OUT/rig-calibration.json   with its lens beside it
//   OUT/rig.yaml               a run's config with that calibration
//   OUT/capture                the run: session and result
//   OUT/summary.json           what each part is good for; of a simulated rig the errors too
#pragma once

#include <filesystem>

#include "app/drivers.h"

namespace turnlight::app {

struct CalibrateRigArguments {
  std::filesystem::path config, out;
  bool yes = false;     // nobody is asked
  bool capture = true;  // else it ends with the calibration
};

// Gives the exit code.
int RunCalibrateRig(const CalibrateRigArguments& arguments, const Drivers& drivers);

}  // namespace turnlight::app
