// The nodes of a capture, put together: one composition for the program and for the tests, whatever
// the devices are.
#pragma once

#include <memory>

#include "nodes/capture_work.h"
#include "nodes/graph/registry.h"
#include "nodes/keyframes_node.h"
#include "rig/rig_setup.h"

namespace turnlight::nodes {

struct CaptureParts {
  rig::RigSetup rig;  // open, once the graph runs
  KeyframesJob job;
  std::shared_ptr<const CaptureWork> work;
};

// The node types that a config may name: keyframes, handheld_keyframes, turntable, camera,
// calibration, recorder, estimator, logger.
graph::NodeRegistry CaptureNodes(CaptureParts parts);

}  // namespace turnlight::nodes
