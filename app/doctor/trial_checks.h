// A hundred pictures, and once around: what only shows when the rig works.
#pragma once

#include "app/doctor/check.h"
#include "app/doctor/patient.h"

namespace turnlight::app {

// Do all of them come whole? Takes them.
Check CheckPackets(Patient& patient);
// How long from the trigger to the picture?
Check CheckLatency(Patient& patient);
// Is the exposure right?
Check CheckLevels(Patient& patient);
// Does the table come back to where it was, a whole turn later? Moves it, and says so.
Check CheckTurn(Patient& patient);

Check JudgePackets(const FrameTrial& trial);

}  // namespace turnlight::app
