#include "tests/loop/stage_loop.h"

#include <chrono>
#include <mutex>
#include <stdexcept>
#include <utility>

#include "base/document.h"
#include "base/strict_object.h"
#include "nodes/capture_nodes.h"
#include "nodes/logger_node.h"
#include "rig/serial/serial_drivers.h"
#include "rig/serial/serial_turntable.h"
#include "rig/sim/blob.h"
#include "rig/sim/stage/stage_simulator.h"
#include "tests/nodes/static_render.h"
#include "tests/temporary_folder.h"

namespace turnlight::loop {
namespace {

using rig::sim::stage::SimulatorEpoch;
using rig::sim::stage::StageSimulator;

template <typename T>
T Expect(Result<T> result) {
  if (!result) throw std::runtime_error(result.error().text);
  return std::move(*result);
}

// The mock camera lives in the simulator's time, a graph in its own.
class ShiftedCamera : public rig::Camera {
 public:
  ShiftedCamera(std::shared_ptr<rig::Camera> camera, SimulatorEpoch epoch)
      : camera_(std::move(camera)), epoch_(epoch) {}

  Result<rig::DeviceIdentity> Open(rig::DeviceTime now) override {
    // Of the first opening there is no clock yet.
    return camera_->Open(now == rig::DeviceTime(0) ? now : Shifted(now));
  }
  Result<rig::CameraSettings> Set(const rig::CameraSettings& settings,
                                  rig::DeviceTime now) override {
    return camera_->Set(settings, Shifted(now));
  }
  Result<int> Drain(rig::DeviceTime now) override { return camera_->Drain(Shifted(now)); }
  Result<std::uint64_t> Trigger(rig::DeviceTime now) override {
    return camera_->Trigger(Shifted(now));
  }
  Result<std::optional<rig::RawFrame>> Poll(rig::DeviceTime now) override {
    auto frame = camera_->Poll(Shifted(now));
    if (frame && *frame) {
      (*frame)->exposure_begin -= offset_;
      (*frame)->exposure_end -= offset_;
    }
    return frame;
  }

 private:
  rig::DeviceTime Shifted(rig::DeviceTime now) {
    if (offset_ == rig::DeviceTime(0)) offset_ = std::chrono::steady_clock::now() - epoch_ - now;
    return now + offset_;
  }

  std::shared_ptr<rig::Camera> camera_;
  SimulatorEpoch epoch_;
  rig::DeviceTime offset_{};
};

rig::sim::MockCameraConfig SmallPictures() {
  rig::sim::MockCameraConfig config;
  config.scene.target = rig::sim::Blob{};
  config.scene.motion.kind = rig::sim::MotionKind::kTable;
  config.scene.camera = {64, 48, 200.0, std::nullopt};
  config.scene.sensor.noise_relative = 0.0003;
  config.scene.samples_per_side = 2;
  return config;
}

StrictObject Parse(const std::string& text, std::vector<std::unique_ptr<Document>>& documents) {
  documents.push_back(std::make_unique<Document>(Expect(ParseYaml(text, "loop.yaml"))));
  return StrictObject(*documents.back());
}

std::string SimulatorText(const StageLoopOptions& options, const std::string& link) {
  const std::string own =
      options.firmware == "grbl" ? std::string(", settings: {22: 1}") : std::string();
  const std::string serial = options.firmware == "zaber" ? "54321" : "TABLE-1";
  return "{firmware: " + options.firmware + ", link: " + link + ", serial: \"" + serial +
         "\", max_speed_deg_s: 300, acceleration_deg_s2: 3000, home_speed_deg_s: 720" + own + "}";
}

std::string DriverText(const StageLoopOptions& options, const std::string& link) {
  const std::string own =
      options.firmware == "zaber" ? ", microsteps_per_turn: 36000" : std::string();
  return "{driver: " + options.firmware + ", port: " + link + ", speed_deg_s: 60" + own + "}";
}

constexpr char kGraph[] = R"(  connections:
    - {from: keyframes.move, to: turntable.move}
    - {from: keyframes.expose, to: camera.expose}
    - {from: turntable.state, to: keyframes.state, policy: {keep_last: 8}}
    - {from: "*.fault", to: logger.faults, policy: {keep_last: 64}}
)";

nodes::graph::Graph BuildLoop(const StageLoopOptions& options, rig::RigSetup rig,
                              std::function<void(const std::string&)> log_line) {
  const std::string text =
      "graph:\n  executor: wall\n  nodes:\n    keyframes: {type: keyframes, params: " +
      options.keyframes_params +
      "}\n    turntable: {type: turntable, params: " + options.turntable_params +
      "}\n    camera: {type: camera}\n    logger: {type: logger}\n" + kGraph;
  auto config = Expect(nodes::graph::ParseGraphConfig(text, "loop.yaml"));
  const auto work = std::make_shared<const nodes::CaptureWork>(
      nodes::CaptureWork{rig::PlannedFrames(options.plan), nullptr, std::move(log_line)});
  nodes::KeyframesJob job;
  job.plan = options.plan;
  return Expect(nodes::graph::Graph::Build(std::move(config),
                                           nodes::CaptureNodes({std::move(rig), job, work})));
}

Result<rig::TableDevice> MakeTable(const std::string& firmware, StrictObject keys) {
  keys.Ignore("driver");
  if (firmware == "grbl") return rig::serial::MakeGrblTable(keys);
  if (firmware == "zaber") return rig::serial::MakeZaberTable(keys);
  return rig::serial::MakeSmc100Table(keys);
}

}  // namespace

StageLoopOptions SmallStageLoop(const std::string& firmware) {
  StageLoopOptions options;
  options.firmware = firmware;
  options.plan.count = 4;
  options.plan.step_deg = 30.0;
  options.plan.settle_ms = 260.0;
  options.plan.frame_timeout_s = 1.0;
  options.plan.move_timeout_s = 6.0;
  return options;
}

std::size_t StageLoopRun::Rejected() const {
  std::size_t rejected = 0;
  for (const nodes::Bracket& bracket : brackets) rejected += bracket.rejected.size();
  return rejected;
}

bool StageLoopRun::Mentions(const std::string& text) const {
  for (const std::string& line : lines)
    if (line.find(text) != std::string::npos) return true;
  return false;
}

StageLoopRun RunStageLoop(const StageLoopOptions& options) {
  const TemporaryFolder folder;
  const std::string link = folder / "port";
  std::vector<std::unique_ptr<Document>> documents;
  rig::sim::SimulationConfig simulation;
  simulation.camera = SmallPictures();
  simulation.faults = options.faults;
  auto world = Expect(rig::sim::BuildWorld(simulation));
  const SimulatorEpoch epoch = std::chrono::steady_clock::now();
  const auto simulator = Expect(
      rig::sim::stage::StartStage(Parse(SimulatorText(options, link), documents), world, epoch));
  auto table = Expect(MakeTable(options.firmware, Parse(DriverText(options, link), documents)));

  rig::CameraDevice camera;
  camera.format = {{64, 48}, 3, CV_16U};
  camera.camera = std::make_shared<ShiftedCamera>(
      std::make_shared<rig::sim::MockCamera>(simulation.camera, world.studio, world.table,
                                             world.faults),
      epoch);
  rig::RigSetup setup{.table = table,
                      .camera = camera,
                      .known = rig::sim::KnowledgeOf(world),
                      .target = rig::sim::TargetOf(world),
                      .calibration = {},
                      .truth = {},
                      .identity = {}};
  if (const Status status = rig::OpenRig(setup); !status)
    throw std::runtime_error(status.error().text);
  StageLoopRun run;
  run.opened = static_cast<rig::serial::SerialTurntable&>(*table.turntable).port_in_use();
  std::mutex mutex;
  auto graph = BuildLoop(options, std::move(setup), [&](const std::string& line) {
    const std::lock_guard lock(mutex);
    run.lines.push_back(line);
  });
  const Status tapped = graph.Tap<nodes::Bracket>(
      "keyframes.bracket",
      [&](const nodes::graph::Message<nodes::Bracket>& m) { run.brackets.push_back(*m); });
  if (!tapped) throw std::runtime_error(tapped.error().text);
  run.report = Expect(graph.Run());
  run.faults_left = world.faults->Remaining();
  run.worst_sigmas = nodes::WorstSigmas(run.brackets, simulation.camera);
  return run;
}

}  // namespace turnlight::loop
