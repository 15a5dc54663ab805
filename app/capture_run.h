// One run of a capture graph into a folder:
//   DIR/config.yaml   the config as it was read; resume and replay take it from here
//   DIR/session       the session (rig/capture/session_recorder.h)
//   DIR/log           what the graph recorded; a resumed run writes log-2, log-3, ...
//   DIR/result        result.json and pictures, unless only a capture was asked for
//   DIR/run.lock      while a run writes here: who it is
#pragma once

#include <filesystem>

#include "app/run_config.h"

namespace turnlight::app {

enum class CaptureStart { kNew, kResume };
enum class CaptureGoal { kEstimate, kSession };

// Gives the exit code. Ctrl-C once: the keyframe is finished, then everything stops in order;
// twice: the motor is stopped now.
int RunCapture(const std::filesystem::path& config, const std::filesystem::path& out,
               CaptureStart start, CaptureGoal goal);

// Runs the graph again from a log of RunCapture, with the devices replaced by what they said.
int ReplayCapture(const std::filesystem::path& log, const std::filesystem::path& out);

}  // namespace turnlight::app
