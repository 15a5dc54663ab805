#include "app/run_folder.h"

#include <system_error>

#include "base/file.h"
#include "base/strict_object.h"
#include "estimator/from_session/session_estimate.h"
#include "rig/session/journal.h"
#include "rig/session/session.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;

constexpr char kRunFile[] = "run.json";

bool Exists(const fs::path& path) {
  std::error_code code;
  return fs::exists(path, code);
}

}  // namespace

fs::path RunFolder::NextLog() const {
  fs::path log = root_ / "log";
  for (int run = 2; Exists(log); ++run) log = root_ / ("log-" + std::to_string(run));
  return log;
}

bool RunFolder::begun() const { return Exists(session() / rig::kJournalFile); }
bool RunFolder::complete() const { return Exists(session() / rig::kSessionFile); }
bool RunFolder::estimated() const { return Exists(result() / "result.json"); }

Status RunFolder::CheckNew() const {
  if (!begun() && !complete()) return {};
  return InputError(root_.string() + ": holds a capture already, allowed is a new folder" +
                    (complete()
                         ? "; turnlight estimate " + session().string() + " estimates it again"
                         : "; turnlight resume " + root_.string() + " goes on with it"));
}

Status RunFolder::CheckBegun() const {
  if (begun()) return {};
  return InputError(root_.string() +
                    ": no capture was begun here, allowed is the folder of a turnlight run or "
                    "capture");
}

Status RunFolder::Begin(const std::string& config_text, const BegunRun& begun) const {
  nlohmann::ordered_json run{{"format", "turnlight-run"},
                             {"version", 1},
                             {"command", begun.goal == CaptureGoal::kEstimate ? "run" : "capture"},
                             {"config", begun.config.string()}};
  if (begun.pixels) run["pixels"] = *begun.pixels;
  if (const Status status = WriteFileAtomic(config(), config_text); !status) return status;
  return WriteFileAtomic(root_ / kRunFile, run.dump() + "\n");
}

Result<BegunRun> RunFolder::ReadBegun() const {
  const auto text = ReadFile(root_ / kRunFile, 1 << 16);
  if (!text) return Forward(text);
  const auto document = ParseJson(*text, (root_ / kRunFile).string());
  if (!document) return Forward(document);
  StrictObject run(*document);
  run.Choice("format", {"turnlight-run"});
  run.Integer("version", 1, 1);
  const std::string command = run.Choice("command", {"run", "capture"});
  const std::string origin = run.OptionalString("config").value_or(config().string());
  const auto pixels = run.OptionalInteger("pixels", estimator::from_session::kFewestPixels,
                                          estimator::from_session::kMostPixelsAllowed);
  if (const Status status = run.Finish(); !status) return Forward(status);
  BegunRun begun{command == "run" ? CaptureGoal::kEstimate : CaptureGoal::kSession, origin, {}};
  if (pixels) begun.pixels = static_cast<std::size_t>(*pixels);
  return begun;
}

}  // namespace turnlight::app
