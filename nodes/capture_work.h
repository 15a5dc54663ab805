// What a capture is to do, known only once its devices are open and its folder is locked: a graph
// is built, and so checked, before that.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "calib/rig_geometry.h"
#include "rig/capture/capture_plan.h"
#include "rig/capture/session_recorder.h"

namespace turnlight::nodes {

// Filled in before the graph runs, and then left alone.
struct CaptureWork {
  std::vector<rig::PlannedFrame> frames;           // still to be taken, in order
  std::shared_ptr<rig::SessionRecorder> recorder;  // null: nothing is stored
  // Of each fault, on the logger's thread; must not throw.
  std::function<void(const std::string& line)> log_line = [](const std::string&) {};
  // Of the frames that are safe already, if the camera is carried by hand.
  std::vector<calib::RigPoses> kept;
  // The frames that are safe already, by index, if the capture goes on until the lights are known;
  // and the session's folder, which their paths are relative to.
  std::map<std::size_t, rig::JournalEntry> kept_entries;
  std::filesystem::path session;
};

}  // namespace turnlight::nodes
