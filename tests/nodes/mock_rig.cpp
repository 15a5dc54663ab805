#include "mock_rig.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <thread>
#include <utility>

#include "base/parallel.h"
#include "nodes/capture_nodes.h"
#include "rig/capture/session_recorder.h"
#include "rig/sim/blob.h"

namespace turnlight::nodes {
namespace {

// The nodes' threads are what is tested here. And the thread sanitizer cannot see how oneTBB, which
// is not built with it, hands work from one thread to another.
class OneThread : public testing::Environment {
  void SetUp() override { SetThreads(1); }
};
[[maybe_unused]] const testing::Environment* const kOneThread =
    testing::AddGlobalTestEnvironment(new OneThread);

constexpr int kColumns = 64;
constexpr int kRows = 48;

// Small, with a textured enough shape: a lump looks different from every side.
rig::sim::MockCameraConfig SmallCamera(const MockRigOptions& options) {
  rig::sim::MockCameraConfig config;
  config.first_frame_id = options.first_frame_id;
  config.scene.seed = options.seed;
  config.scene.target = rig::sim::Blob{};
  config.scene.motion.kind = rig::sim::MotionKind::kTable;
  config.scene.camera = {kColumns, kRows, 200.0, std::nullopt};
  config.scene.sensor.noise_relative = 0.0003;
  config.scene.samples_per_side = 2;
  return config;
}

std::string GraphText(const MockRigOptions& options) {
  const bool whole = !options.session.empty();
  std::string text = "graph:\n  executor: " + options.executor + R"(
  nodes:
    keyframes: {type: keyframes, params: )" +
                     options.keyframes_params + R"(}
    turntable: {type: turntable, params: {poll_ms: 10, home_timeout_s: 20}}
    camera: {type: camera}
)";
  if (whole)
    text +=
        "    calibration: {type: calibration, duration_ms: 5}\n"
        "    recorder: {type: recorder, duration_ms: 20}\n"
        "    estimator: {type: estimator, duration_ms: 5000, params: " +
        options.estimator_params + "}\n    logger: {type: logger}\n";
  text += R"(  connections:
    - {from: keyframes.move, to: turntable.move}
    - {from: keyframes.expose, to: camera.expose}
    - {from: turntable.state, to: keyframes.state, policy: {keep_last: 8}}
)";
  if (whole)
    text +=
        "    - {from: keyframes.bracket, to: calibration.bracket, policy: block}\n"
        "    - {from: calibration.keyframe, to: recorder.keyframe, policy: block}\n"
        "    - {from: calibration.keyframe, to: estimator.keyframe, " +
        options.to_estimator +
        "}\n    - {from: calibration.camera_model, to: estimator.camera_model, policy: block}\n"
        "    - {from: \"*.fault\", to: logger.faults, policy: {keep_last: 64}}\n";
  return text + "  record: [keyframes.bracket, keyframes.fault" +
         (whole ? ", turntable.fault, camera.fault, estimator.estimate]\n" : "]\n");
}

template <typename T>
T Expect(Result<T> result) {
  if (!result) throw std::runtime_error(result.error().text);
  return std::move(*result);
}
void Expect(const Status& status) {
  if (!status) throw std::runtime_error(status.error().text);
}

using Recorder = std::shared_ptr<rig::SessionRecorder>;

Recorder OpenRecorder(const MockRigOptions& options, const rig::RigSetup& setup) {
  if (options.session.empty()) return nullptr;
  const rig::CaptureSetup capture{.plan = options.plan,
                                  .config_text = "a test",
                                  .name = "lump",
                                  .length_unit = setup.length_unit,
                                  .camera = setup.known.lens,
                                  .calibration_text = "",
                                  .radiometry = setup.known.radiometry,
                                  .bayer = setup.camera.bayer,
                                  .target = setup.target.copy,
                                  .format = setup.camera.format,
                                  .camera_identity = "turnlight, mock camera, 1",
                                  .table_identity = "turnlight, mock turntable, 1"};
  const bool begun = std::filesystem::exists(options.session / rig::kJournalFile);
  return std::make_shared<rig::SessionRecorder>(
      Expect(begun ? rig::SessionRecorder::Resume(options.session, capture, {}, *options.disk)
                   : rig::SessionRecorder::Start(options.session, capture, {}, *options.disk)));
}

// Table and camera of the run, as a capture takes them.
rig::RigSetup MakeRig(const MockRigOptions& options, const MockRigRun& run) {
  const rig::sim::Studio& studio = run.camera->studio();
  const auto& lump = std::get<calib::MeshShape>(studio.target);
  std::shared_ptr<rig::Camera> camera = run.camera;
  if (options.wrap_camera) camera = options.wrap_camera(camera);
  rig::CameraDevice device;
  device.camera = std::move(camera);
  device.format = {{kColumns, kRows}, 3, CV_16U};
  return {.table = {run.table, {}},
          .camera = std::move(device),
          .known = {studio.camera, rig::sim::GeometryOf(run.camera->config().scene.motion),
                    studio.radiometry, rig::SensorNoise{}},
          .target = {lump, rig::MeshCopy{rig::MeshFormat::kPly, rig::sim::MeshToPly(lump)}},
          .calibration = {},
          .truth = {},
          .identity = {}};
}

// Appends every message of the topic to the list.
template <typename T>
void Collect(graph::Graph& graph, const std::string& topic, std::vector<T>& list) {
  Expect(
      graph.Tap<T>(topic, [&list](const graph::Message<T>& message) { list.push_back(*message); }));
}

// A thread that asks a graph to stop once there is a keyframe, while the capture waits for it; it
// is gone before the graph is.
class StopFromOutside {
 public:
  StopFromOutside(graph::Graph& graph, std::optional<graph::StopMode> mode) {
    if (!mode) return;
    Expect(graph.Tap<Bracket>("keyframes.bracket", [this](const graph::Message<Bracket>&) {
      WakeUp();
      asked_.wait(false);
    }));
    thread_ = std::jthread([this, &graph, mode] {
      awake_.wait(false);
      graph.RequestStop(*mode);
      asked_ = true;
      asked_.notify_one();
    });
  }
  ~StopFromOutside() { WakeUp(); }

 private:
  void WakeUp() {
    awake_ = true;
    awake_.notify_one();
  }
  std::atomic<bool> awake_{false}, asked_{false};
  std::jthread thread_;
};

}  // namespace

MockRigOptions SmallCapture() {
  MockRigOptions options;
  options.plan.count = 4;
  options.plan.step_deg = 30.0;
  options.plan.settle_ms = 300.0;
  options.plan.frame_timeout_s = 1.0;
  return options;
}

MockRigOptions WholeCapture(const std::filesystem::path& session) {
  MockRigOptions options = SmallCapture();
  options.session = session;
  return options;
}

rig::sim::FaultEntry FaultAt(rig::sim::FaultKind kind, std::optional<double> angle_deg, int times) {
  rig::sim::FaultEntry entry = rig::sim::MakeFault(kind);
  entry.angle_deg = angle_deg;
  entry.times = times;
  return entry;
}

std::size_t MockRigRun::Rejected() const {
  std::size_t rejected = 0;
  for (const Bracket& bracket : brackets) rejected += bracket.rejected.size();
  return rejected;
}

const graph::ConnectionReport& MockRigRun::Connection(const std::string& from,
                                                      const std::string& to) const {
  for (const graph::ConnectionReport& connection : report.connections)
    if (connection.from == from && connection.to == to) return connection;
  throw std::runtime_error("no connection from " + from + " to " + to);
}

MockRigRun RunMockRig(const MockRigOptions& options) {
  MockRigRun run;
  run.faults = std::make_shared<rig::sim::FaultScript>(options.faults);
  run.table = std::make_shared<rig::sim::MockTurntable>(options.table, run.faults);
  run.camera = Expect(rig::sim::MockCamera::Create(SmallCamera(options), run.table, run.faults));
  rig::RigSetup setup = MakeRig(options, run);
  Expect(rig::OpenRig(setup));
  const Recorder recorder = OpenRecorder(options, setup);
  const auto work = std::make_shared<const CaptureWork>(
      CaptureWork{recorder ? recorder->Missing() : rig::PlannedFrames(options.plan),
                  recorder,
                  [&run](const std::string& line) { run.lines.push_back(line); },
                  {},
                  {},
                  {}});
  auto config = Expect(graph::ParseGraphConfig(GraphText(options), "mock_rig.yaml"));
  auto graph = Expect(graph::Graph::Build(
      std::move(config),
      CaptureNodes({std::move(setup),
                    {options.plan, options.gate, options.check_arrival, options.settle},
                    work})));
  Collect(graph, "keyframes.bracket", run.brackets);
  if (recorder) Collect(graph, "estimator.estimate", run.estimates);
  if (options.before_run) options.before_run(graph);
  StopFromOutside stop(graph, options.stop_after_first);
  const graph::RunOptions how{.log = options.log};
  run.report = Expect(options.replay.empty() ? graph.Run(how) : graph.Replay(options.replay, how));
  if (recorder) run.still_missing = recorder->Missing();
  return run;
}

}  // namespace turnlight::nodes
