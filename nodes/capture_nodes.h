// The nodes of a capture, put together: one composition for the program and for the tests, whatever
// the devices are.
#pragma once

#include <functional>
#include <memory>

#include "calib/camera_model.h"
#include "calib/target_shape.h"
#include "nodes/calibration_node.h"
#include "nodes/graph/registry.h"
#include "nodes/keyframes_node.h"
#include "nodes/logger_node.h"
#include "rig/capture/session_recorder.h"
#include "rig/device.h"

namespace turnlight::nodes {

struct CaptureParts {
  std::shared_ptr<rig::Turntable> table;  // open, once the graph runs; so is the camera
  std::shared_ptr<rig::Camera> camera;
  KeyframesJob job;  // its radiometry is that of the camera's raw DN
  calib::CameraModel lens;
  rig::SensorNoise noise;
  std::function<CameraAndTarget(double angle_deg)> place;
  calib::TargetShape target;
  std::shared_ptr<rig::SessionRecorder> recorder;  // null: nothing is stored
  LoggerNode::Sink log_line;
};

// The node types that a config may name: keyframes, turntable, camera, calibration, recorder,
// estimator, logger.
graph::NodeRegistry CaptureNodes(CaptureParts parts);

}  // namespace turnlight::nodes
