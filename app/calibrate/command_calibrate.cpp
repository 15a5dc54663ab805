#include "app/calibrate/calibrate_commands.h"
#include "app/command.h"

namespace turnlight::app {

void AddCalibrate(CLI::App& program, Action& action) {
  CLI::App* calibrate = program.add_subcommand(
      "calibrate", "From pictures to a rig's calibration, each part with its uncertainty");
  calibrate->require_subcommand(1);
  AddCalibrateAxis(*calibrate, action);
  AddCalibrateCapture(*calibrate, action);
  AddCalibrateCheck(*calibrate, action);
  AddCalibrateIntrinsics(*calibrate, action);
  AddCalibrateResponse(*calibrate, action);
  AddCalibrateRig(*calibrate, action);
  AddCalibrateTarget(*calibrate, action);
  AddCalibrateLights(*calibrate, action);
}

}  // namespace turnlight::app
