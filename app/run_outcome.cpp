#include "app/run_outcome.h"

#include "app/exit_code.h"
#include "base/printable.h"
#include "nodes/logger_node.h"

namespace turnlight::app {

std::string OutcomeText(const RunOutcome& outcome, const std::string& hint) {
  const std::string begin = "turnlight: ";
  std::string text;
  if (outcome.report.failure && !outcome.failure_shown)
    text += begin + Printable(nodes::FaultLine(*outcome.report.failure)) + "\n";
  for (const std::string& node : outcome.report.hung)
    text += begin + node + ": hangs: it did not come back when the run stopped, and was left\n";
  if (outcome.missing > 0)
    text += begin + std::to_string(outcome.missing) +
            (outcome.missing == 1 ? " frame is missing" : " frames are missing") +
            ", the others are safe; " + hint + "\n";
  else if (outcome.report.failure || outcome.interrupted)
    text += begin + "all frames are safe; " + hint + "\n";
  return text;
}

int ExitCodeOf(const RunOutcome& outcome) {
  const auto& failure = outcome.report.failure;
  if (outcome.interrupted) return kInterrupted;
  if (failure && failure->code == "device") return kDeviceFault;
  return outcome.missing > 0 || failure || !outcome.session_complete ? kIncomplete : kDone;
}

}  // namespace turnlight::app
