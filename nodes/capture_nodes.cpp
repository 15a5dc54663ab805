#include "nodes/capture_nodes.h"

#include <utility>

#include "nodes/camera_node.h"
#include "nodes/estimator_node.h"
#include "nodes/recorder_node.h"
#include "nodes/turntable_node.h"

namespace turnlight::nodes {
namespace {

RigCalibration CalibrationOf(const CaptureParts& parts) {
  const rig::CapturePlan& plan = parts.job.plan;
  const calib::Radiometry& raw = parts.job.radiometry;
  return {parts.lens, rig::RawRadiometry(raw, plan.exposures_us, plan.gain_db),
          rig::SessionRadiometry(raw, plan.exposures_us, plan.gain_db), parts.noise, parts.place};
}

}  // namespace

graph::NodeRegistry CaptureNodes(CaptureParts parts) {
  const auto shared = std::make_shared<const CaptureParts>(std::move(parts));
  graph::NodeRegistry registry;
  registry.Add("keyframes", [shared] { return std::make_unique<KeyframesNode>(shared->job); });
  registry.Add("turntable", [shared] { return std::make_unique<TurntableNode>(shared->table); });
  registry.Add("camera", [shared] { return std::make_unique<CameraNode>(shared->camera); });
  registry.Add("calibration",
               [shared] { return std::make_unique<CalibrationNode>(CalibrationOf(*shared)); });
  registry.Add("recorder", [shared] { return std::make_unique<RecorderNode>(shared->recorder); });
  registry.Add("estimator", [shared] { return std::make_unique<EstimatorNode>(shared->target); });
  registry.Add("logger", [shared] { return std::make_unique<LoggerNode>(shared->log_line); });
  return registry;
}

}  // namespace turnlight::nodes
