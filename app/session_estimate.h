// A session's folder to the folder of its result: what `estimate` does, and what ends `run`,
// `resume` and `replay`. The estimate itself is estimator/from_session; here are its progress for a
// person, Ctrl-C, and the files.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "base/result.h"
#include "estimator/from_session/session_estimate.h"
#include "rig/capture/closure_check.h"

namespace turnlight::app {

struct WriteOptions {
  estimator::from_session::Options estimate;  // without initial, progress, on_closure and stop
  std::string initial;                        // a truth.json or result.json; empty: none
  bool pictures = true;
};

struct WrittenEstimate {
  std::string json;     // result.json, as written
  std::string summary;  // for a person, ended with what was written
  std::optional<rig::ClosureCheck> closure;
};

// Creates out. Says the verdict of the closure check before the long part. Ctrl-C before anything
// is written ends it with kInterrupted. Fails with kNoEstimate if the session gives none, in words
// that say what to do.
Result<WrittenEstimate> WriteEstimate(const std::filesystem::path& session,
                                      const std::filesystem::path& out,
                                      const WriteOptions& options = {});

}  // namespace turnlight::app
