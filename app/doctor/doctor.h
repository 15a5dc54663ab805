// All checks of `turnlight doctor`, in their order. A further one is a function and a line in the
// list.
#pragma once

#include <functional>
#include <vector>

#include "app/doctor/check.h"
#include "app/doctor/patient.h"

namespace turnlight::app {

// Makes the devices that the config names, runs every check, and tells each as it is done. Fails
// (kInput) on a device section that its driver refuses; (kInterrupted) once patient.stop is raised.
Result<std::vector<Check>> Examine(Patient& patient, const std::function<void(const Check&)>& tell);

}  // namespace turnlight::app
