#include "app/capture_run.h"

#include <iostream>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <utility>

#include "app/capture_display.h"
#include "app/closure.h"
#include "app/exit_code.h"
#include "app/interrupt.h"
#include "app/progress_table.h"
#include "app/rig_config.h"
#include "app/run_config.h"
#include "app/run_outcome.h"
#include "app/session_estimate.h"
#include "app/version.h"
#include "base/file.h"
#include "base/format.h"
#include "base/lock_file.h"
#include "base/utc.h"
#include "nodes/capture_work.h"
#include "nodes/graph/graph.h"
#include "nodes/graph/log.h"
#include "nodes/logger_node.h"
#include "rig/rig_setup.h"
#include "rig/session/journal.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;
using Recorder = std::shared_ptr<rig::SessionRecorder>;

enum class Start { kNew, kResume };

// What is asked for.
struct Task {
  fs::path config;
  RunFolder folder;
  Start start = Start::kNew;
  BegunRun begun;
  const Drivers* drivers = nullptr;
  fs::path replayed;  // of a replay: the session whose devices speak from the log
};

// Everything of one run, put together.
struct Prepared {
  RunConfig config;
  std::optional<LockFile> lock;
  rig::RigSetup rig;
  Recorder recorder;
  std::unique_ptr<CaptureDisplay> display;
  std::optional<nodes::graph::Graph> graph;
};

Status Tap(Prepared& run) {
  CaptureDisplay* display = run.display.get();
  for (const nodes::graph::NodeConfig& node : run.graph->parts().config.nodes) {
    Status status;
    if (node.type == "keyframes" || node.type == "handheld_keyframes")
      status = run.graph->Tap<nodes::Bracket>(
          node.name + ".bracket",
          [display](const nodes::graph::Message<nodes::Bracket>& m) { display->OnBracket(*m); });
    if (status && node.type == "keyframes")
      status = run.graph->Tap<nodes::Pace>(
          node.name + ".pace",
          [display](const nodes::graph::Message<nodes::Pace>& m) { display->OnPace(*m); });
    if (status && node.type == "handheld_keyframes")
      status = run.graph->Tap<nodes::Guidance>(
          node.name + ".guide",
          [display](const nodes::graph::Message<nodes::Guidance>& m) { display->OnGuidance(*m); });
    if (node.type == "estimator")
      status = run.graph->Tap<nodes::Estimate>(
          node.name + ".estimate",
          [display](const nodes::graph::Message<nodes::Estimate>& m) { display->OnEstimate(*m); });
    if (status && node.type == "estimator")
      status = run.graph->Tap<nodes::Verdict>(
          node.name + ".verdict",
          [display](const nodes::graph::Message<nodes::Verdict>& m) { display->OnVerdict(*m); });
    if (!status) return status;
  }
  return {};
}

// The devices as the journal names them, and never opened in a replay.
struct DeviceNames {
  std::string camera, table;
};

Result<DeviceNames> NameDevices(rig::RigSetup& rig, const Task& task) {
  if (!task.replayed.empty()) {
    const auto journal = rig::ReadJournal(task.replayed);
    if (!journal) return Forward(journal);
    return DeviceNames{journal->header.camera_identity, journal->header.table_identity};
  }
  if (const Status status = rig::OpenRig(rig); !status) return Forward(status);
  return DeviceNames{rig::Describe(rig.identity->camera),
                     rig.table.turntable ? rig::Describe(rig.identity->table) : "none"};
}

Result<Recorder> OpenRecorder(const Prepared& run, const DeviceNames& names, const Task& task) {
  const fs::path session = task.folder.session();
  const rig::CaptureSetup setup = MakeCaptureSetup(run.config, run.rig, names.camera, names.table);
  rig::RunProvenance provenance;
  provenance.program_version = Version();
  provenance.program_commit = Commit();
  provenance.utc = UtcNow();
  provenance.camera_settings = {run.config.plan.exposures_us.front(), run.config.plan.gain_db};
  auto recorder = task.start == Start::kNew
                      ? rig::SessionRecorder::Start(session, setup, provenance)
                      : rig::SessionRecorder::Resume(session, setup, provenance);
  if (!recorder) return Forward(recorder);
  if (run.rig.truth)
    if (const Status status = WriteFileAtomic(session / "truth.json", *run.rig.truth); !status)
      return Forward(status);
  return std::make_shared<rig::SessionRecorder>(std::move(*recorder));
}

// What is about to happen.
std::string Announce(const Prepared& run, const RunFolder& folder,
                     const std::vector<rig::PlannedFrame>& missing, Start start) {
  const auto planned = rig::PlannedFrames(run.config.plan);
  std::string text = run.config.name + ": ";
  if (start == Start::kNew && run.config.plan.by_hand)
    return text +
           Format("%zu frames, %.10g\u00b0 of view change apart, into ", planned.size(),
                  run.config.plan.step_deg) +
           folder.session().string() + "; carry the camera round the target";
  if (start == Start::kNew)
    return text +
           Format("%zu frames from %.10g\u00b0 to %.10g\u00b0 into ", planned.size(),
                  planned.front().angle_deg, planned.back().angle_deg) +
           folder.session().string();
  for (const std::string& dropped : run.recorder->report().dropped)
    text += dropped + "; taken again\n";
  text += Format("%zu of %zu frames are safe", planned.size() - missing.size(), planned.size());
  return missing.empty() || run.config.plan.by_hand
             ? text
             : text + Format(", going on at %.10g\u00b0", missing.front().angle_deg);
}

// A device that does not open: what to do, and what has become of the run.
Error NotThere(Error error, Start start) {
  if (error.kind != ErrorKind::kDevice) return error;
  error.text += "; check its cable and power, then give the same command again: ";
  error.text += start == Start::kNew ? "nothing was written" : "what was taken is safe";
  return error;
}

// The graph of the task. A capture without estimates leaves the estimator out, unless it says when
// there is enough; and a config that is wrong about it is refused nevertheless.
Result<nodes::graph::Graph> MakeGraph(RunConfig& config, const rig::RigSetup& rig, CaptureGoal goal,
                                      std::shared_ptr<const nodes::CaptureWork> work) {
  auto graph = BuildGraph(config, rig, work);
  if (!graph || goal == CaptureGoal::kEstimate || config.plan.until ||
      !RemoveNodes(config.graph, "estimator"))
    return graph;
  return BuildGraph(config, rig, work);
}

// The folder is this run's from here on.
Status TakeFolder(Prepared& run, const Task& task) {
  const RunFolder& folder = task.folder;
  if (const Status status = MakeDirectory(folder.root()); !status) return status;
  auto lock = LockFile::Take(folder.lock(), folder.root().string() + ": another run writes here");
  if (!lock) return Forward(lock);
  run.lock.emplace(std::move(*lock));
  if (task.start == Start::kResume) return folder.CheckBegun();
  if (const Status status = folder.CheckNew(); !status) return status;
  return folder.Begin(run.config.text, task.begun);
}

// The config is read, and everything that can be refused is, before anything is written.
Result<Prepared> Prepare(const Task& task) {
  auto config = ReadRunConfig(task.config, task.begun.config);
  if (!config) return Forward(config);
  auto rig = MakeRig(*config, *task.drivers);
  if (!rig) return Forward(rig);
  Prepared run{std::move(*config), {}, std::move(*rig), {}, {}, {}};
  const auto work = std::make_shared<nodes::CaptureWork>();
  auto graph = MakeGraph(run.config, run.rig, task.begun.goal, work);
  if (!graph) return Forward(graph);
  run.graph.emplace(std::move(*graph));
  const auto names = NameDevices(run.rig, task);
  if (!names) return tl::unexpected<Error>(NotThere(names.error(), task.start));

  if (const Status status = TakeFolder(run, task); !status) return Forward(status);
  auto recorder = OpenRecorder(run, *names, task);
  if (!recorder) return Forward(recorder);
  run.recorder = work->recorder = std::move(*recorder);
  work->frames = run.recorder->Missing();
  work->session = task.folder.session();
  if (run.config.plan.until) work->kept_entries = run.recorder->entries();
  for (const auto& [index, entry] : run.recorder->entries())
    work->kept.push_back({entry.frame.X_WC, entry.frame.X_WT});
  std::cerr << Announce(run, task.folder, work->frames, task.start) << std::endl;
  const std::size_t total = rig::PlannedFrames(run.config.plan).size();
  run.display = std::make_unique<CaptureDisplay>(total, total - work->frames.size());
  work->log_line = [display = run.display.get()](const std::string& line) {
    display->OnLine(line);
  };
  if (const Status tapped = Tap(run); !tapped) return Forward(tapped);
  return run;
}

std::string ResumeHint(const RunFolder& folder) {
  return "turnlight resume " + folder.root().string() + " goes on";
}

// The system said no: what was begun can be gone on with.
int FailIn(const RunFolder& folder, Error error) {
  if (error.kind == ErrorKind::kSystem && folder.begun() &&
      error.text.find("turnlight resume") == std::string::npos)
    error.text += "; " + ResumeHint(folder);
  return Fail(error);
}

// The folder of the run whose log it is.
RunFolder SourceOf(const fs::path& log) { return RunFolder(fs::absolute(log).parent_path()); }

std::string ReplayHint(const fs::path& log) {
  return log.string() +
         " has no more: that run was interrupted or resumed, and a log holds one run; " +
         SourceOf(log).session().string() + " has what all runs together took";
}

// Runs the graph to its end, from a log if there is one; the exit code.
int RunGraph(Prepared& run, const RunFolder& folder, const fs::path& log = {}) {
  // In a replay there is no keyframe to wait for: what the log holds is there already.
  const InterruptStopsGraph interrupt(
      *run.graph, log.empty() ? nodes::graph::StopMode::kDrain : nodes::graph::StopMode::kNow);
  nodes::graph::RunOptions options;
  options.log = folder.NextLog();
  const auto report = log.empty() ? run.graph->Run(options) : run.graph->Replay(log, options);
  if (!report) return FailIn(folder, report.error());
  const bool wall = run.config.graph.executor == nodes::graph::ExecutorKind::kWall;
  run.display->End(log.empty() && wall);
  const auto& failure = report->failure;
  const RunOutcome outcome{*report, failure && run.display->Showed(nodes::FaultLine(*failure)),
                           run.recorder->Missing().size(), folder.complete(), Interrupted()};
  const bool goes_on = log.empty() || outcome.interrupted;
  std::cerr << OutcomeText(outcome, goes_on ? ResumeHint(folder) : ReplayHint(log)) << std::flush;
  return ExitCodeOf(outcome);
}

// A finished session to its goal. The result is solved from the session's files alone, so that it
// is the one that `estimate` gives.
int Finish(const RunFolder& folder, const BegunRun& begun,
           const std::vector<nodes::Estimate>& estimates) {
  const fs::path session = folder.session();
  if (begun.goal == CaptureGoal::kSession) {
    const auto closure = TellClosure(session);
    if (!closure) return Fail(closure.error());
    std::cout << session.string() << " is complete; turnlight estimate " << session.string()
              << " --out " << folder.result().string() << " estimates the lights" << std::endl;
    return ExitCodeOf(*closure);
  }
  std::cerr << session.string() << " is complete; the final estimate starts anew from its frames"
            << std::endl;
  if (!estimates.empty()) {
    Status status = MakeDirectory(folder.result());
    if (status)
      status = WriteFileAtomic(folder.result() / "progress.csv", ProgressTable(estimates));
    if (!status) return Fail(status.error());
  }
  WriteOptions options;
  if (begun.pixels) options.estimate.most_pixels = *begun.pixels;
  const auto done = WriteEstimate(session, folder.result(), options);
  if (!done) return Fail(done.error());
  std::cout << done->summary << std::flush;
  return ExitCodeOf(done->closure);
}

// Of a capture that goes on until the lights are known only its end says that nothing is missing.
bool IsToRun(const Prepared& run, const RunFolder& folder) {
  if (!run.config.plan.until) return !run.recorder->Missing().empty();
  return !folder.complete() || !run.recorder->report().dropped.empty();
}

int Capture(const Task& task) {
  const RunFolder& folder = task.folder;
  auto run = Prepare(task);
  if (!run) return FailIn(folder, run.error());
  if (IsToRun(*run, folder)) {
    const int code = RunGraph(*run, folder);
    if (code != kDone) return code;
  } else if (run->config.plan.until) {
    // Its session is complete, with the reason why it ended.
  } else if (const Status status = run->recorder->Finish(); !status) {
    return FailIn(folder, status.error());
  }
  return Finish(folder, task.begun, run->display->estimates());
}

// A replay is of the same config; which part is not, the hashes tell.
Status CheckSameConfig(const fs::path& log, const std::string& recorded, const RunConfig& config) {
  std::istringstream was(recorded), is(config.graph.hash);
  std::string was_name, was_hash, is_name, is_hash;
  while (is >> is_name >> is_hash)
    if (!(was >> was_name >> was_hash) || was_name != is_name || was_hash != is_hash)
      return InputError(log.string() + ": recorded with another \"" + is_name + "\" than " +
                        config.file + " has, allowed is the config of that run");
  return {};
}

}  // namespace

int RunCapture(const fs::path& config, const RunFolder& folder, CaptureGoal goal,
               const Drivers& drivers, std::optional<std::size_t> pixels) {
  const BegunRun begun{goal, fs::absolute(config), pixels};
  return Capture({config, folder, Start::kNew, begun, &drivers, {}});
}

int ResumeCapture(const RunFolder& folder, const Drivers& drivers) {
  if (const Status status = folder.CheckBegun(); !status) return Fail(status.error());
  const auto begun = folder.ReadBegun();
  if (!begun) return Fail(begun.error());
  if (folder.complete() && (begun->goal == CaptureGoal::kSession || folder.estimated())) {
    std::cout << folder.root().string() << ": complete already, nothing is left to do" << std::endl;
    const auto closure = TellClosure(folder.session());
    return closure ? ExitCodeOf(*closure) : Fail(closure.error());
  }
  return Capture({folder.config(), folder, Start::kResume, *begun, &drivers, {}});
}

int ReplayCapture(const fs::path& log, const RunFolder& folder, const Drivers& drivers) {
  if (std::error_code ignored; fs::is_directory(log, ignored))
    return Fail({ErrorKind::kInput, log.string() + ": a folder, allowed is the log of a run, " +
                                        (log / "log").string() + " for example"});
  const auto reader = nodes::graph::LogReader::Open(log);
  if (!reader) return Fail(reader.error());
  const RunFolder source = SourceOf(log);
  const auto begun = source.ReadBegun();
  if (!begun) return Fail(begun.error());
  const auto config = ReadRunConfig(source.config(), begun->config);
  if (!config) return Fail(config.error());
  if (const Status status = CheckSameConfig(log, reader->header().config_hash, *config); !status)
    return Fail(status.error());
  auto run = Prepare({source.config(), folder, Start::kNew, *begun, &drivers, source.session()});
  if (!run) return Fail(run.error());
  const int code = RunGraph(*run, folder, log);
  return code == kDone ? Finish(folder, *begun, run->display->estimates()) : code;
}

}  // namespace turnlight::app
