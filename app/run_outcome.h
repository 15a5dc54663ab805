// What the end of a graph means for the program, in words and as an exit code.
#pragma once

#include <cstddef>
#include <string>

#include "nodes/graph/graph.h"

namespace turnlight::app {

struct RunOutcome {
  const nodes::graph::RunReport& report;
  bool failure_shown = false;  // a line of the run has said it already
  std::size_t missing = 0;     // frames
  bool session_complete = false;
  bool interrupted = false;
};

// Lines for standard error, each ended; empty if all is done. hint: how to go on.
std::string OutcomeText(const RunOutcome& outcome, const std::string& hint);
int ExitCodeOf(const RunOutcome& outcome);

}  // namespace turnlight::app
