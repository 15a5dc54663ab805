// The computer: disk and clocks.
#pragma once

#include <optional>

#include "app/doctor/check.h"
#include "app/doctor/patient.h"

namespace turnlight::app {

// Is the disk faster than the pictures come? Writes some tens of megabytes and removes them.
Check CheckDiskSpeed(Patient& patient);
// Is there space for the plan?
Check CheckFreeSpace(Patient& patient);
// Does the clock that everything is timed by go steadily?
Check CheckSteadyClock(Patient& patient);
// Is the time of day right? It is a label only.
Check CheckTimeOfDay(Patient& patient);

// What a plan needs of a disk.
struct DiskNeed {
  double bytes_per_frame = 0.0, seconds_per_frame = 0.0, bytes = 0.0;
};
Check JudgeDiskSpeed(double bytes_per_s, const std::optional<DiskNeed>& need);
Check JudgeFreeSpace(double free_bytes, const std::optional<DiskNeed>& need);
// synchronised: by adjtimex.
Check JudgeTimeOfDay(bool synchronised, double error_s);

}  // namespace turnlight::app
