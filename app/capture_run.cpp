#include "app/capture_run.h"

#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "app/capture_display.h"
#include "app/command.h"
#include "app/interrupt.h"
#include "app/session_estimate.h"
#include "app/version.h"
#include "base/file.h"
#include "base/lock_file.h"
#include "nodes/graph/graph.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;
using Recorder = std::shared_ptr<rig::SessionRecorder>;

constexpr char kConfigCopy[] = "config.yaml";

// The first of log, log-2, log-3, ... that is not there.
fs::path FreeLog(const fs::path& out) {
  fs::path log = out / "log";
  for (int run = 2; fs::exists(log); ++run) log = out / ("log-" + std::to_string(run));
  return log;
}

Result<Recorder> OpenRecorder(const RunConfig& config, const Rig& rig, const fs::path& out,
                              CaptureStart start) {
  auto setup = MakeCaptureSetup(config, rig, out);
  if (!setup) return Forward(setup);
  rig::RunProvenance run;
  run.program_version = VersionText();
  run.camera_settings = {config.plan.exposures_us.front(), config.plan.gain_db};
  auto recorder = start == CaptureStart::kNew
                      ? rig::SessionRecorder::Start(out / "session", *setup, run)
                      : rig::SessionRecorder::Resume(out / "session", *setup, run);
  if (!recorder) return Forward(recorder);
  return std::make_shared<rig::SessionRecorder>(std::move(*recorder));
}

// Everything of one run, put together.
struct Prepared {
  RunConfig config;
  std::optional<LockFile> lock;
  Rig rig;
  Recorder recorder;
  std::unique_ptr<CaptureDisplay> display;
  std::optional<graph::Graph> graph;
};

Status Tap(Prepared& run) {
  CaptureDisplay* display = run.display.get();
  for (const graph::NodeConfig& node : run.graph->parts().config.nodes) {
    Status status;
    if (node.type == "keyframes")
      status = run.graph->Tap<nodes::Bracket>(
          node.name + ".bracket",
          [display](const graph::Message<nodes::Bracket>& m) { display->OnBracket(*m); });
    if (node.type == "estimator")
      status = run.graph->Tap<nodes::Estimate>(
          node.name + ".estimate",
          [display](const graph::Message<nodes::Estimate>& m) { display->OnEstimate(*m); });
    if (!status) return status;
  }
  return {};
}

Result<Prepared> Prepare(const fs::path& config_file, const fs::path& out, CaptureStart start,
                         CaptureGoal goal) {
  Prepared run;
  auto config = ReadRunConfig(config_file);
  if (!config) return Forward(config);
  run.config = std::move(*config);
  if (goal == CaptureGoal::kSession) RemoveNodes(run.config.graph, "estimator");
  if (const Status status = MakeDirectory(out); !status) return Forward(status);
  auto lock = LockFile::Take(out / "run.lock", out.string() + ": another run is writing here");
  if (!lock) return Forward(lock);
  run.lock.emplace(std::move(*lock));
  auto rig = MakeRig(run.config);
  if (!rig) return Forward(rig);
  run.rig = std::move(*rig);
  auto recorder = OpenRecorder(run.config, run.rig, out, start);
  if (!recorder) return Forward(recorder);
  run.recorder = std::move(*recorder);
  if (start == CaptureStart::kNew)
    if (const Status status = WriteFileAtomic(out / kConfigCopy, run.config.text); !status)
      return Forward(status);
  const auto missing = run.recorder->Missing();
  const std::size_t total = rig::PlannedFrames(run.config.plan).size();
  run.display = std::make_unique<CaptureDisplay>(total, total - missing.size());
  auto graph = graph::Graph::Build(
      run.config.graph,
      MakeRegistry(
          run.rig, MakeKeyframesJob(run.config, run.rig, missing), run.recorder,
          [display = run.display.get()](const std::string& line) { display->OnLine(line); }));
  if (!graph) return Forward(graph);
  run.graph.emplace(std::move(*graph));
  if (const Status status = Tap(run); !status) return Forward(status);
  if (const Status status = run.graph->Configure(); !status) return Forward(status);
  return run;
}

// What a stop of the graph means for the program.
int Outcome(const graph::RunReport& report, std::size_t missing, const fs::path& out) {
  if (report.failure)
    std::cerr << "turnlight: " << report.failure->node << ": " << report.failure->text << "\n";
  if (missing > 0)
    std::cerr << "turnlight: " << missing << " frames are missing, the others are safe; "
              << "turnlight resume " << out.string() << " goes on" << std::endl;
  if (Interrupted()) return kInterrupted;
  if (report.failure && report.failure->code == "device") return kDeviceFault;
  if (missing > 0) return kIncomplete;
  return report.failure ? kRefused : kDone;
}

int Finish(const fs::path& out, CaptureGoal goal) {
  const fs::path session = out / "session";
  if (goal == CaptureGoal::kSession) {
    std::cout << session.string() << " is complete; turnlight estimate " << session.string()
              << " --out " << (out / "result").string() << " estimates the lights" << std::endl;
    return kDone;
  }
  const auto done = EstimateSession(session, out / "result", {});
  if (!done) return Fail(done.error());
  std::cout << done->summary << std::flush;
  return kDone;
}

}  // namespace

int RunCapture(const fs::path& config, const fs::path& out, CaptureStart start, CaptureGoal goal) {
  auto run = Prepare(start == CaptureStart::kNew ? config : out / kConfigCopy, out, start, goal);
  if (!run) return Fail(run.error());
  graph::RunOptions options;
  options.log = FreeLog(out);
  int code = kDone;
  if (!run->recorder->Missing().empty()) {
    const InterruptStopsGraph interrupt(*run->graph);
    const auto report = run->graph->Run(options);
    if (!report) return Fail(report.error());
    run->display.reset();
    code = Outcome(*report, run->recorder->Missing().size(), out);
  } else if (const Status status = run->recorder->Finish(); !status) {
    return Fail(status.error());
  }
  return code == kDone ? Finish(out, goal) : code;
}

int ReplayCapture(const fs::path& log, const fs::path& out) {
  const fs::path folder = log.parent_path();
  auto run = Prepare(folder / kConfigCopy, out, CaptureStart::kNew, CaptureGoal::kEstimate);
  if (!run) return Fail(run.error());
  graph::RunOptions options;
  options.log = FreeLog(out);
  const auto report = run->graph->Replay(log, options);
  if (!report) return Fail(report.error());
  run->display.reset();
  const int code = Outcome(*report, run->recorder->Missing().size(), out);
  return code == kDone ? Finish(out, CaptureGoal::kEstimate) : code;
}

}  // namespace turnlight::app
