// A small simulated rig and the nodes that photograph with it, for the tests of this folder.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/file.h"
#include "nodes/graph/graph.h"
#include "nodes/keyframes_node.h"
#include "nodes/messages.h"
#include "rig/sim/mock_camera.h"
#include "rig/sim/mock_turntable.h"

namespace turnlight::nodes {

struct MockRigOptions {
  rig::CapturePlan plan;  // 4 keyframes of 30 degrees unless changed
  std::vector<rig::sim::FaultEntry> faults;
  rig::sim::MockTurntableConfig table;
  rig::FrameGate gate;
  bool check_arrival = true;
  bool settle = true;
  std::string executor = "virtual";
  std::uint64_t seed = 1;  // of the scene and its noise
  int first_frame_id = 1;
  // Given: calibration, recorder, estimator and logger run as well, and the session goes there. One
  // that was begun is resumed.
  std::filesystem::path session;
  FileOps* disk = &SystemFileOps();  // of the recorder
  std::string to_estimator = "policy: block, capacity: 64";
  std::string estimator_params = "{every: 4}";
  std::string keyframes_params = "{retry_wait_ms: 200}";
  std::filesystem::path log;
  std::filesystem::path replay;  // given: this log is replayed instead
  // Puts another camera in front of the simulated one.
  std::function<std::shared_ptr<rig::Camera>(std::shared_ptr<rig::Camera>)> wrap_camera;
  std::function<void(graph::Graph&)> before_run;
  // Given: another thread asks for it once the first keyframe is there.
  std::optional<graph::StopMode> stop_after_first;
};
MockRigOptions SmallCapture();
// The same with all nodes.
MockRigOptions WholeCapture(const std::filesystem::path& session);

// The fault while that angle is commanded, at any angle if none.
rig::sim::FaultEntry FaultAt(rig::sim::FaultKind kind, std::optional<double> angle_deg,
                             int times = 1);

struct MockRigRun {
  std::shared_ptr<rig::sim::MockTurntable> table;
  std::shared_ptr<rig::sim::MockCamera> camera;
  std::shared_ptr<rig::sim::FaultScript> faults;
  std::vector<Bracket> brackets;
  std::vector<Estimate> estimates;
  std::vector<std::string> lines;                // of the logger
  std::vector<rig::PlannedFrame> still_missing;  // in the session
  graph::RunReport report;

  std::size_t Rejected() const;
  const graph::ConnectionReport& Connection(const std::string& from, const std::string& to) const;
};
// Runs the whole capture; an ill-formed graph ends the test.
MockRigRun RunMockRig(const MockRigOptions& options);

}  // namespace turnlight::nodes
