#include "nodes/capture_nodes.h"

#include <optional>
#include <utility>

#include "nodes/calibration_node.h"
#include "nodes/camera_node.h"
#include "nodes/estimator_node.h"
#include "nodes/handheld_keyframes_node.h"
#include "nodes/logger_node.h"
#include "nodes/recorder_node.h"
#include "nodes/turntable_node.h"

namespace turnlight::nodes {
namespace {

BracketCalibration CalibrationOf(const CaptureParts& parts) {
  const rig::CapturePlan& plan = parts.job.plan;
  const rig::RigKnowledge& known = parts.rig.known;
  return {known.lens, rig::RawRadiometry(known.radiometry, plan.exposures_us, plan.gain_db),
          rig::SessionRadiometry(known.radiometry, plan.exposures_us, plan.gain_db), known.noise,
          known.geometry};
}

std::optional<JudgeParts> JudgeOf(const CaptureParts& parts) {
  const rig::CapturePlan& plan = parts.job.plan;
  if (!plan.until) return std::nullopt;
  const int depth = plan.exposures_us.size() > 1 ? CV_32F : parts.rig.camera.format.depth;
  const BracketCalibration calibration = CalibrationOf(parts);
  return JudgeParts{plan, calibration.geometry, {calibration.session, depth}, parts.work};
}

}  // namespace

graph::NodeRegistry CaptureNodes(CaptureParts parts) {
  const auto shared = std::make_shared<const CaptureParts>(std::move(parts));
  graph::NodeRegistry registry;
  registry.Add("keyframes", [shared] {
    return std::make_unique<KeyframesNode>(shared->job, shared->rig.known.radiometry, shared->work);
  });
  registry.Add("handheld_keyframes", [shared] {
    return std::make_unique<HandheldKeyframesNode>(shared->job.plan, shared->job.gate, shared->rig,
                                                   shared->work);
  });
  registry.Add("turntable",
               [shared] { return std::make_unique<TurntableNode>(shared->rig.table.turntable); });
  registry.Add("camera",
               [shared] { return std::make_unique<CameraNode>(shared->rig.camera.camera); });
  registry.Add("calibration",
               [shared] { return std::make_unique<CalibrationNode>(CalibrationOf(*shared)); });
  registry.Add("recorder", [shared] {
    return std::make_unique<RecorderNode>(shared->work, shared->job.plan.until.has_value());
  });
  registry.Add("estimator", [shared] {
    return std::make_unique<EstimatorNode>(shared->rig.target.shape, JudgeOf(*shared));
  });
  registry.Add("logger", [shared] {
    return std::make_unique<LoggerNode>(
        [work = shared->work](const std::string& line) { work->log_line(line); });
  });
  return registry;
}

}  // namespace turnlight::nodes
