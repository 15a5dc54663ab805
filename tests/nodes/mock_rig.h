// A small simulated rig and the three nodes that photograph with it, for the tests of this folder.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "nodes/graph/graph.h"
#include "nodes/keyframes_node.h"
#include "rig/sim/mock_camera.h"
#include "rig/sim/mock_turntable.h"

namespace turnlight::nodes {

struct MockRigOptions {
  rig::CapturePlan plan;  // 4 keyframes of 30 degrees unless changed
  std::vector<rig::FaultEntry> faults;
  rig::TableFeedback feedback = rig::TableFeedback::kEncoder;
  bool check_arrival = true;
  bool settle = true;
  std::string executor = "virtual";
};
MockRigOptions SmallCapture();

struct MockRigRun {
  std::shared_ptr<rig::MockCamera> camera;
  std::shared_ptr<rig::FaultScript> faults;
  std::vector<Bracket> brackets;
  graph::RunReport report;

  // Of the worst frame: its distance from the static render at its commanded angle.
  rig::MockCamera::Deviation Worst() const;
  std::size_t Rejected() const;
};
// Runs the whole capture; an ill-formed graph ends the test.
MockRigRun RunMockRig(const MockRigOptions& options, const std::string& log = "");

}  // namespace turnlight::nodes
