// One run of a capture graph into a folder (app/run_folder.h), a resume of it, a replay of its log.
// Each gives the exit code.
#pragma once

#include <filesystem>

#include "app/drivers.h"
#include "app/run_folder.h"

namespace turnlight::app {

// Ctrl-C once: the keyframe is finished, then everything stops in order; twice: the motor is
// stopped now. pixels: how many the final estimate may hold, by default its own number.
int RunCapture(const std::filesystem::path& config, const RunFolder& folder, CaptureGoal goal,
               const Drivers& drivers = BuiltInDrivers(), std::optional<std::size_t> pixels = {});

// Goes on with what was begun, to the goal with which it was begun; whatever is there already is
// kept.
int ResumeCapture(const RunFolder& folder, const Drivers& drivers = BuiltInDrivers());

// Runs the graph again from a log, with the devices replaced by what they said; none is opened. A
// log holds one run: of a capture that was interrupted it gives the frames up to there.
int ReplayCapture(const std::filesystem::path& log, const RunFolder& folder,
                  const Drivers& drivers = BuiltInDrivers());

}  // namespace turnlight::app
