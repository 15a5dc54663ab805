#include "mock_rig.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "nodes/camera_node.h"
#include "nodes/turntable_node.h"

namespace turnlight::nodes {
namespace {

std::string GraphText(const std::string& executor) {
  return "graph:\n  executor: " + executor + R"(
  nodes:
    keyframes: {type: keyframes, params: {retry_wait_ms: 200}}
    turntable: {type: turntable, params: {poll_ms: 10, home_timeout_s: 20}}
    camera: {type: camera}
  connections:
    - {from: keyframes.move, to: turntable.move}
    - {from: keyframes.expose, to: camera.expose}
    - {from: turntable.state, to: keyframes.state, policy: {keep_last: 8}}
  record: [keyframes.bracket, keyframes.fault]
)";
}

// Small, with a textured enough shape: a lump looks different from every side.
rig::MockCameraConfig SmallCamera() {
  rig::MockCameraConfig config;
  config.scene.target = rig::Blob{};
  config.scene.motion.kind = rig::MotionKind::kTable;
  config.scene.camera = {64, 48, 104.0, std::nullopt};
  config.scene.sensor.noise_relative = 0.002;
  config.scene.samples_per_side = 2;
  return config;
}

template <typename T>
T Expect(Result<T> result) {
  if (!result) throw std::runtime_error(result.error().text);
  return std::move(*result);
}

}  // namespace

MockRigOptions SmallCapture() {
  MockRigOptions options;
  options.plan.count = 4;
  options.plan.step_deg = 30.0;
  options.plan.settle_ms = 300.0;
  options.plan.frame_timeout_s = 1.0;
  return options;
}

rig::MockCamera::Deviation MockRigRun::Worst() const {
  rig::MockCamera::Deviation worst;
  for (const Bracket& bracket : brackets)
    for (const Frame& frame : bracket.exposures) {
      rig::RawFrame raw;
      raw.image = frame.image;
      raw.actual = frame.actual;
      const auto deviation = camera->DeviationFromStatic(raw, bracket.angle_deg);
      worst.max_sigmas = std::max(worst.max_sigmas, deviation.max_sigmas);
      worst.rms_sigmas = std::max(worst.rms_sigmas, deviation.rms_sigmas);
      worst.share_beyond_5 = std::max(worst.share_beyond_5, deviation.share_beyond_5);
    }
  return worst;
}

std::size_t MockRigRun::Rejected() const {
  std::size_t rejected = 0;
  for (const Bracket& bracket : brackets) rejected += bracket.rejected.size();
  return rejected;
}

MockRigRun RunMockRig(const MockRigOptions& options, const std::string& log) {
  MockRigRun run;
  run.faults = std::make_shared<rig::FaultScript>(options.faults);
  rig::MockTurntableConfig table_config;
  table_config.feedback = options.feedback;
  const auto table = std::make_shared<rig::MockTurntable>(table_config, run.faults);
  run.camera = Expect(rig::MockCamera::Create(SmallCamera(), table, run.faults));
  KeyframesJob job{options.plan,
                   rig::PlannedFrames(options.plan),
                   run.camera->studio().radiometry,
                   {},
                   options.check_arrival,
                   options.settle};
  graph::NodeRegistry registry;
  registry.Add("keyframes", [&job] { return std::make_unique<KeyframesNode>(job); });
  registry.Add("turntable", [&table] { return std::make_unique<TurntableNode>(table); });
  registry.Add("camera", [&run] { return std::make_unique<CameraNode>(run.camera); });
  auto config = Expect(graph::ParseGraphConfig(GraphText(options.executor), "mock_rig.yaml"));
  auto graph = Expect(graph::Graph::Build(std::move(config), registry));
  const Status tapped = graph.Tap<Bracket>(
      "keyframes.bracket",
      [&run](const graph::Message<Bracket>& bracket) { run.brackets.push_back(*bracket); });
  if (!tapped) throw std::runtime_error(tapped.error().text);
  run.report = Expect(graph.Run({.log = log}));
  return run;
}

}  // namespace turnlight::nodes
