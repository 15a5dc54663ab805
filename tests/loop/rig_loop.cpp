#include "tests/loop/rig_loop.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <utility>

#include "base/document.h"
#include "base/format.h"
#include "base/parallel.h"
#include "base/strict_object.h"
#include "nodes/capture_nodes.h"
#include "nodes/logger_node.h"
#include "rig/aravis/aravis_camera.h"
#include "rig/serial/serial_drivers.h"
#include "rig/serial/serial_turntable.h"
#include "rig/sim/blob.h"
#include "tests/temporary_folder.h"

namespace turnlight::loop {
namespace {

// Rigs side by side have the processors to share; and the thread sanitizer does not know how TBB
// synchronises.
class OneThread : public testing::Environment {
  void SetUp() override { SetThreads(1); }
};
[[maybe_unused]] const testing::Environment* const kOneThread =
    testing::AddGlobalTestEnvironment(new OneThread);

constexpr int kWidth = 64, kHeight = 48;

template <typename T>
T Expect(Result<T> result) {
  if (!result) throw std::runtime_error(result.error().text);
  return std::move(*result);
}

rig::sim::SimulationConfig World(const RigLoopOptions& options) {
  rig::sim::SimulationConfig simulation;
  rig::sim::SyntheticConfig& scene = simulation.camera.scene;
  scene.target = rig::sim::Blob{};
  scene.motion.kind = rig::sim::MotionKind::kTable;
  scene.camera = {kWidth, kHeight, 200.0, std::nullopt};
  scene.sensor.noise_relative = 0.0001;
  scene.sensor.noise_shot = 0.0002;
  scene.samples_per_side = 2;
  simulation.faults = options.faults;
  return simulation;
}

rig::sim::gige::CameraConfig CameraOf(const RigLoopOptions& options,
                                      const rig::sim::SimulationConfig& simulation,
                                      const RigPlace& place) {
  rig::sim::gige::CameraConfig config = rig::sim::gige::DefaultCamera(simulation);
  config.address = place.address;
  config.format = rig::sim::gige::FindPixelFormat(options.pixel_format);
  config.packet_loss = options.packet_loss;
  return config;
}

StrictObject Parse(const std::string& text, std::vector<std::unique_ptr<Document>>& documents) {
  documents.push_back(std::make_unique<Document>(Expect(ParseYaml(text, "loop.yaml"))));
  return StrictObject(*documents.back());
}

std::string StageText(const RigLoopOptions& options, const std::string& link) {
  const std::string own =
      options.firmware == "grbl" ? std::string(", settings: {22: 1}") : std::string();
  const std::string serial = options.firmware == "zaber" ? "54321" : "TABLE-1";
  return "{firmware: " + options.firmware + ", link: " + link + ", serial: \"" + serial +
         "\", max_speed_deg_s: 300, acceleration_deg_s2: 3000, home_speed_deg_s: 720" + own + "}";
}

std::string TableText(const RigLoopOptions& options, const std::string& link) {
  const std::string own =
      options.firmware == "zaber" ? ", microsteps_per_turn: 36000" : std::string();
  return "{port: " + link + ", speed_deg_s: 60" + own + "}";
}

std::string CameraText(const RigLoopOptions& options, const RigPlace& place) {
  return Format("{id: %s, pixel_format: %s, size: [%d, %d], readout_ms: 15, packet_size: %d}",
                place.address.c_str(), options.pixel_format.c_str(), kWidth, kHeight,
                options.packet_size);
}

constexpr char kConnections[] = R"(  connections:
    - {from: keyframes.move, to: turntable.move}
    - {from: keyframes.expose, to: camera.expose}
    - {from: turntable.state, to: keyframes.state, policy: {keep_last: 8}}
    - {from: "*.fault", to: logger.faults, policy: {keep_last: 64}}
)";

nodes::graph::Graph BuildLoop(const RigLoopOptions& options, rig::RigSetup rig,
                              std::function<void(const std::string&)> log_line) {
  const std::string text =
      "graph:\n  executor: wall\n  nodes:\n    keyframes: {type: keyframes, params: " +
      options.keyframes_params +
      "}\n    turntable: {type: turntable, params: " + options.turntable_params +
      "}\n    camera: {type: camera, params: {poll_ms: 2}}\n    logger: {type: logger}\n" +
      kConnections;
  auto config = Expect(nodes::graph::ParseGraphConfig(text, "loop.yaml"));
  const auto work = std::make_shared<const nodes::CaptureWork>(nodes::CaptureWork{
      rig::PlannedFrames(options.plan), nullptr, std::move(log_line), {}, {}, {}});
  nodes::KeyframesJob job;
  job.plan = options.plan;
  job.check_arrival = options.check_arrival;
  job.settle = options.settle;
  return Expect(nodes::graph::Graph::Build(std::move(config),
                                           nodes::CaptureNodes({std::move(rig), job, work})));
}

rig::TableDevice MakeTable(const std::string& firmware, StrictObject keys) {
  if (firmware == "grbl") return Expect(rig::serial::MakeGrblTable(keys));
  if (firmware == "zaber") return Expect(rig::serial::MakeZaberTable(keys));
  return Expect(rig::serial::MakeSmc100Table(keys));
}

rig::RigSetup OpenDevices(const RigLoopOptions& options, const RigPlace& place) {
  std::vector<std::unique_ptr<Document>> documents;
  const auto world = Expect(rig::sim::BuildWorld(World(options)));
  rig::RigSetup setup{
      .table = MakeTable(options.firmware, Parse(TableText(options, place.link), documents)),
      .camera = Expect(rig::aravis::MakeAravisCamera(Parse(CameraText(options, place), documents))),
      .known = rig::sim::gige::KnowledgeOf(world, CameraOf(options, world.config, place)),
      .target = rig::sim::TargetOf(world),
      .calibration = {},
      .truth = {},
      .identity = {}};
  if (const Status status = rig::OpenRig(setup); !status)
    throw std::runtime_error(status.error().text);
  return setup;
}

}  // namespace

RigLoopOptions SmallRigLoop(const std::string& firmware) {
  RigLoopOptions options;
  options.firmware = firmware;
  options.plan.count = 4;
  options.plan.step_deg = 30.0;
  options.plan.settle_ms = 260.0;
  options.plan.frame_timeout_s = 4.0;
  options.plan.move_timeout_s = 6.0;
  return options;
}

RigPlace OwnPlace(const std::string& folder) {
  static std::atomic<int> count{0};
  const int pid = ::getpid();
  return {folder + "/port", Format("127.%d.%d.%d", 1 + (count++ + 40 * (pid / 65024)) % 80,
                                   pid / 254 % 256, 1 + pid % 254)};
}

SimulatedRig::SimulatedRig(const RigLoopOptions& options, const RigPlace& place)
    : world_(Expect(rig::sim::BuildWorld(World(options)))) {
  std::vector<std::unique_ptr<Document>> documents;
  stage_ = Expect(rig::sim::stage::StartStage(Parse(StageText(options, place.link), documents),
                                              world_, epoch_));
  camera_ = Expect(
      rig::sim::gige::GigeCamera::Start(CameraOf(options, world_.config, place), world_, epoch_));
}

bool SimulatedRig::IsMoving() const {
  const auto state = world_.table->State(std::chrono::steady_clock::now() - epoch_);
  return state && state->motion == rig::TableMotion::kMoving;
}

double SimulatedRig::SecondsSinceFirstFault() const {
  const auto fired = world_.faults->Fired();
  if (fired.empty()) return 0.0;
  const rig::DeviceTime now = std::chrono::steady_clock::now() - epoch_;
  return std::chrono::duration<double>(now - fired.front().time).count();
}

std::size_t RigLoopRun::Rejected() const {
  std::size_t rejected = 0;
  for (const nodes::Bracket& bracket : brackets) rejected += bracket.rejected.size();
  return rejected;
}

bool RigLoopRun::Mentions(const std::string& text) const {
  for (const std::string& line : lines)
    if (line.find(text) != std::string::npos) return true;
  return false;
}

RigLoopRun RunCapture(const RigLoopOptions& options, const RigPlace& place) {
  rig::RigSetup setup = OpenDevices(options, place);
  RigLoopRun run;
  run.opened = static_cast<rig::serial::SerialTurntable&>(*setup.table.turntable).port_in_use();
  std::mutex mutex;
  auto graph = BuildLoop(options, std::move(setup), [&](const std::string& line) {
    const std::lock_guard lock(mutex);
    run.lines.push_back(line);
  });
  const Status tapped = graph.Tap<nodes::Bracket>(
      "keyframes.bracket", [&](const nodes::graph::Message<nodes::Bracket>& message) {
        if (options.on_bracket)
          options.on_bracket(*message);
        else
          run.brackets.push_back(*message);
      });
  if (!tapped) throw std::runtime_error(tapped.error().text);
  run.report = Expect(graph.Run());
  return run;
}

RigLoopRun RunRigLoop(const RigLoopOptions& options) {
  const TemporaryFolder folder;
  const RigPlace place = OwnPlace(folder.path());
  SimulatedRig simulated(options, place);
  RigLoopRun run = RunCapture(options, place);
  run.seconds_from_fault = simulated.SecondsSinceFirstFault();
  run.moving = simulated.IsMoving();
  run.faults_left = simulated.faults().Remaining();
  const nodes::StaticScene scene = SceneOf(options);
  for (const nodes::Bracket& bracket : run.brackets)
    run.worst_sigmas = std::max(run.worst_sigmas, scene.WorstSigmas(bracket));
  return run;
}

std::vector<RigLoopRun> RunAll(const std::vector<RigLoopOptions>& all) {
  std::vector<RigLoopRun> runs(all.size());
  std::vector<std::jthread> threads;
  for (std::size_t i = 0; i < all.size(); ++i)
    threads.emplace_back([&, i] {
      try {
        runs[i] = RunRigLoop(all[i]);
      } catch (const std::exception& error) {
        ADD_FAILURE() << error.what();
      }
    });
  threads.clear();
  return runs;
}

nodes::StaticScene SceneOf(const RigLoopOptions& options) {
  const rig::sim::gige::PixelFormat& format =
      *rig::sim::gige::FindPixelFormat(options.pixel_format);
  return nodes::StaticScene(World(options).camera,
                            {format.bits, format.layout == rig::sim::gige::PixelLayout::kBayerRg});
}

rig::sim::FaultEntry Fault(rig::sim::FaultKind kind, std::optional<double> angle_deg, int times) {
  rig::sim::FaultEntry entry = rig::sim::MakeFault(kind);
  entry.angle_deg = angle_deg;
  entry.times = times;
  return entry;
}

rig::sim::FaultEntry CameraFault(rig::sim::FaultKind kind, std::optional<double> angle_deg,
                                 int times) {
  rig::sim::FaultEntry entry = Fault(kind, angle_deg, times);
  entry.device = rig::sim::FaultDevice::kCamera;
  return entry;
}

}  // namespace turnlight::loop
