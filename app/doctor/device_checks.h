// The devices, opened: who they are, whether they are as the config says.
#pragma once

#include "app/doctor/check.h"
#include "app/doctor/patient.h"

namespace turnlight::app {

// Is the whole config one for `turnlight run`?
Check CheckRunConfig(Patient& patient);
// The controller's firmware and settings; opens the table.
Check CheckController(Patient& patient);
// Does it know where it stands?
Check CheckPosition(Patient& patient);
// Opens the camera, with the settings that it lacks.
Check CheckCamera(Patient& patient);
// Exposure and gain, set and read back.
Check CheckExposure(Patient& patient);
// The calibration against the pictures and the devices.
Check CheckCalibrationPictures(Patient& patient);
Check CheckCalibrationDevices(Patient& patient);

}  // namespace turnlight::app
