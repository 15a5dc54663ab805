// A capture in the loop: the real nodes and a real driver against a simulated controller on a real
// port, with a mock camera that photographs the simulated table at its true angle. In real time.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "nodes/graph/graph.h"
#include "nodes/messages.h"
#include "rig/capture/capture_plan.h"
#include "rig/sim/fault_script.h"
#include "rig/sim/mock_camera.h"

namespace turnlight::loop {

struct StageLoopOptions {
  std::string firmware;  // grbl, zaber, smc100
  std::vector<rig::sim::FaultEntry> faults;
  rig::CapturePlan plan;  // 4 keyframes of 30 degrees unless changed
  std::string keyframes_params = "{retry_wait_ms: 200, lost_timeout_s: 10}";
  std::string turntable_params = "{poll_ms: 10, home_timeout_s: 5}";
};
StageLoopOptions SmallStageLoop(const std::string& firmware);

struct StageLoopRun {
  std::vector<nodes::Bracket> brackets;
  std::vector<std::string> lines;  // faults and notes, as a log shows them
  nodes::graph::RunReport report;
  int faults_left = 0;  // that never struck
  std::string opened;   // by which library
  // The largest deviation of a picture from the static render at its angle, in sigmas of its noise.
  double worst_sigmas = 0.0;

  std::size_t Rejected() const;
  bool Mentions(const std::string& text) const;
};
// Throws what does not open: a test's set-up is wrong then.
StageLoopRun RunStageLoop(const StageLoopOptions& options);

}  // namespace turnlight::loop
