// The folder of one run of a capture graph:
//   DIR/config.yaml   the config as it was read; resume and replay take it from here
//   DIR/run.json      what was begun: {"format": "turnlight-run", "version": 1, "command": "run",
//                     "config": "/.../FILE.yaml"}, the file that config.yaml is a copy of; and
//                     "pixels", if the estimate is to hold another number than by default
//   DIR/session       the session (rig/capture/session_recorder.h); a simulated rig leaves its
//                     truth.json there
//   DIR/log           what the graph recorded; a resumed run writes log-2, log-3, ...
//   DIR/result        result.json, pictures and progress.csv, unless only a capture was asked for
//   DIR/run.lock      while a program writes here: who it is
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include "base/result.h"

namespace turnlight::app {

enum class CaptureGoal { kEstimate, kSession };  // run; capture

struct BegunRun {
  CaptureGoal goal = CaptureGoal::kEstimate;
  std::filesystem::path config;       // the file that was read; absolute
  std::optional<std::size_t> pixels;  // --pixels
};

class RunFolder {
 public:
  explicit RunFolder(std::filesystem::path root) : root_(std::move(root)) {}

  const std::filesystem::path& root() const { return root_; }
  std::filesystem::path config() const { return root_ / "config.yaml"; }
  std::filesystem::path session() const { return root_ / "session"; }
  std::filesystem::path result() const { return root_ / "result"; }
  std::filesystem::path lock() const { return root_ / "run.lock"; }
  // The first of log, log-2, log-3, ... that is not there.
  std::filesystem::path NextLog() const;

  bool begun() const;  // there is something to resume
  bool complete() const;
  bool estimated() const;

  // Fails (kInput) if a capture was begun here; and if none was.
  Status CheckNew() const;
  Status CheckBegun() const;

  // Writes config.yaml and run.json; before the session is begun.
  Status Begin(const std::string& config_text, const BegunRun& run) const;
  Result<BegunRun> ReadBegun() const;

 private:
  std::filesystem::path root_;
};

}  // namespace turnlight::app
