#include "rig/capture/session_recorder.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <system_error>

#include "base/format.h"
#include "base/sha256.h"
#include "rig/capture/exposure_merge.h"
#include "rig/session/image_file.h"

namespace turnlight::rig {
namespace {

namespace fs = std::filesystem;

constexpr char kLockFile[] = "capture.lock";
constexpr char kFrames[] = "frames";
constexpr std::uint64_t kSpareBytes = 1 << 20;  // for the journal and session.json

std::string ShowMegabytes(std::uint64_t bytes) {
  const std::uint64_t tenths = (bytes + 99'999) / 100'000;
  return std::to_string(tenths / 10) + "." + std::to_string(tenths % 10) + " MB";
}

// "frames/007", of as many digits as the last frame needs; "frames/closure".
std::string StemOf(const CaptureSetup& setup, const PlannedFrame& planned) {
  const std::string stem = std::string(kFrames) + "/";
  if (planned.closure) return stem + "closure";
  const std::int64_t extra = setup.plan.until ? setup.plan.until->most_extra : 0;
  const std::size_t digits =
      std::max<std::size_t>(3, std::to_string(setup.plan.count + extra - 1).size());
  const std::string number = std::to_string(planned.index);
  return stem + std::string(digits - number.size(), '0') + number;
}

// The nearest folder of a path that is there.
fs::path ExistingFolder(fs::path path) {
  std::error_code code;
  path = fs::absolute(path, code);
  while (!fs::is_directory(path, code) && path.has_relative_path()) path = path.parent_path();
  return path;
}

// A capture goes on only with what it began with.
Status CheckSameCapture(const fs::path& file, const JournalHeader& was, const JournalHeader& is) {
  if (PrintJournalLine(was) == PrintJournalLine(is)) return {};
  const auto hash = [](const JournalHeader& header) { return Sha256Hex(header.config_text); };
  const std::pair<const char*, std::pair<std::string, std::string>> parts[] = {
      {"camera", {was.camera_identity, is.camera_identity}},
      {"turntable", {was.table_identity, is.table_identity}},
      {"camera model (SHA-256)", {was.camera_sha256, is.camera_sha256}},
      {"mesh (SHA-256)", {was.mesh_sha256.value_or("none"), is.mesh_sha256.value_or("none")}},
      {"config (SHA-256)", {hash(was), hash(is)}}};
  for (const auto& [name, values] : parts)
    if (values.first != values.second)
      return InputError(file.string() + ": this capture was begun with the " + name + " \"" +
                        values.first + "\", now it is \"" + values.second +
                        "\"; allowed is to resume with the same");
  return InputError(
      file.string() +
      ": this capture was begun with another plan (section capture); allowed is to resume with "
      "the same");
}

Status CheckKeyframe(const RecordedKeyframe& keyframe, const CaptureSetup& setup,
                     const std::string& label) {
  const int type = CV_MAKETYPE(StoredDepth(setup), setup.format.channels);
  if (keyframe.image.size() != setup.format.size || keyframe.image.type() != type)
    return InputError(label + ": a picture of " + std::to_string(keyframe.image.cols) + " x " +
                      std::to_string(keyframe.image.rows) + " pixels of " +
                      cv::typeToString(keyframe.image.type()) + ", allowed are " +
                      std::to_string(setup.format.size.width) + " x " +
                      std::to_string(setup.format.size.height) + " of " + cv::typeToString(type));
  if (!keyframe.validity.empty() &&
      (keyframe.validity.size() != setup.format.size || cv::countNonZero(keyframe.validity) == 0))
    return InputError(label + ": the validity map is of another size or leaves no pixel");
  const auto& exposure_us = keyframe.exposure.exposure_us;
  if (!exposure_us || !(*exposure_us > 0.0) || !std::isfinite(*exposure_us) ||
      !std::isfinite(keyframe.exposure.gain_db) || !std::isfinite(keyframe.angle_measured_deg))
    return InputError(label + ": exposure, gain or measured angle is missing or no number");
  for (const auto& [name, pose] : {std::pair("X_WC", keyframe.X_WC), {"X_WT", keyframe.X_WT}})
    if (const auto checked = calib::PoseFromRows(calib::RowsFromPose(pose), label + ": " + name);
        !checked)
      return Forward(checked);
  return {};
}

JournalEntry MakeEntry(const RecordedKeyframe& keyframe, const PlannedFrame& planned,
                       const CaptureSetup& setup) {
  const std::string stem = StemOf(setup, planned);
  JournalEntry entry;
  entry.index = planned.index;
  entry.frame.image = stem + (StoredDepth(setup) == CV_32F ? ".exr" : ".png");
  if (!keyframe.validity.empty()) entry.frame.validity = stem + ".validity.png";
  if (!planned.by_hand) {
    entry.frame.angle_deg = planned.angle_deg;
    entry.frame.angle_measured_deg = keyframe.angle_measured_deg;
  }
  entry.frame.exposure = keyframe.exposure;
  entry.frame.has_gain = true;
  entry.frame.X_WC = keyframe.X_WC;
  entry.frame.X_WT = keyframe.X_WT;
  return entry;
}

// What a killed process left behind.
Status RemoveTemporaries(const fs::path& folder, FileOps& ops) {
  std::error_code code;
  for (fs::directory_iterator at(folder, code), end; !code && at != end; at.increment(code)) {
    const fs::path path = at->path();
    if (IsTemporaryName(path.filename().string()) && ops.Unlink(path.c_str()) != 0)
      return SystemError(path.string() + ": cannot remove this temporary file");
  }
  return {};
}

std::string PrintJournal(const JournalHeader& header,
                         const std::map<std::size_t, JournalEntry>& entries) {
  std::string text = PrintJournalLine(header);
  for (const auto& [index, entry] : entries) text += PrintJournalLine(entry);
  return text;
}

// What can be done after a fault of the disk. Before there is a journal nothing was begun that
// could be gone on with.
std::string WhenTheDiskIsWell(const fs::path& root) {
  std::error_code code;
  return fs::exists(root / kJournalFile, code)
             ? "when the disk is well again, `turnlight resume` completes the capture"
             : "nothing was begun: make room, or name a folder on another disk, and start again";
}

}  // namespace

SessionRecorder::SessionRecorder(fs::path root, CaptureSetup setup, FileOps& ops)
    : root_(std::move(root)),
      setup_(std::move(setup)),
      ops_(&ops),
      planned_(PlannedFrames(setup_.plan)) {}

Result<SessionRecorder> SessionRecorder::Start(const fs::path& root, const CaptureSetup& setup,
                                               const RunProvenance& run, FileOps& ops) {
  return Open(root, setup, run, ops, false);
}

Result<SessionRecorder> SessionRecorder::Resume(const fs::path& root, const CaptureSetup& setup,
                                                const RunProvenance& run, FileOps& ops) {
  std::error_code code;
  if (!fs::exists(root / kJournalFile, code))
    return InputError((root / kJournalFile).string() +
                      ": not there; no capture was begun in this folder, start one");
  return Open(root, setup, run, ops, true);
}

Result<SessionRecorder> SessionRecorder::Open(const fs::path& root, const CaptureSetup& setup,
                                              const RunProvenance& run, FileOps& ops, bool resume) {
  if (const Status status = CheckSetup(setup); !status) return Forward(status);
  SessionRecorder recorder(root, setup, ops);
  recorder.header_ = MakeHeader(setup);
  Status status = resume ? Status() : recorder.CheckSpaceForMissing();
  if (status) status = MakeDirectory(root, ops);
  if (!status) return Forward(recorder.Break(status));
  auto lock =
      LockFile::Take(root / kLockFile, root.string() + ": another capture writes here", ops);
  if (!lock) return Forward(recorder.Break(Forward(lock)));
  recorder.lock_ = std::move(*lock);
  status = resume ? recorder.Recover() : recorder.CheckFresh();
  if (status) status = recorder.Begin(run, resume);
  if (!status) return Forward(recorder.Break(status));
  return recorder;
}

Status SessionRecorder::CheckFresh() const {
  std::error_code code;
  for (const auto& [name, what] :
       {std::pair(kSessionFile, "holds a session already, allowed is a new folder"),
        {kJournalFile,
         "holds a capture that was begun already, allowed is to resume it or a new "
         "folder"}})
    if (fs::exists(root_ / name, code)) return InputError(root_.string() + ": " + what);
  return {};
}

// What of the journal still holds.
Status SessionRecorder::Recover() {
  const auto journal = ReadJournal(root_);
  if (!journal) return Forward(journal);
  const Status same = CheckSameCapture(root_ / kJournalFile, journal->header, header_);
  if (!same) return same;
  report_.dropped = journal->problems;
  for (const JournalEntry& entry : journal->entries) {
    const auto problems = EntryProblems(root_, entry);
    for (const std::string& problem : problems)
      report_.dropped.push_back(EntryLabel(header_, entry.index) + ": " + problem);
    if (problems.empty()) entries_.emplace(entry.index, entry);
  }
  report_.kept = entries_.size();
  std::error_code code;
  if (setup_.plan.until && report_.dropped.empty() && fs::exists(root_ / kSessionFile, code))
    ended_.emplace();
  if (journal->text != PrintJournal(header_, entries_)) {
    const Status status =
        WriteFileAtomic(root_ / kJournalFile, PrintJournal(header_, entries_), *ops_);
    if (!status) return status;
  }
  return CheckSpaceForMissing();
}

// The journal comes last: without it, nothing was begun.
Status SessionRecorder::Begin(const RunProvenance& run, bool resume) {
  Status status = MakeDirectory(root_ / kFrames, *ops_);
  for (const fs::path& folder : {root_, root_ / kFrames})
    if (status) status = RemoveTemporaries(folder, *ops_);
  for (const auto& [name, bytes] : CopiesOf(setup_))
    if (status && ReadFile(root_ / name) != bytes)
      status = WriteFileAtomic(root_ / name, bytes, *ops_);
  if (!status) return status;

  // A torn line of a killed run is ended, so that it does not spoil the next.
  const std::string before = ReadFile(root_ / kProvenanceFile).value_or("");
  const std::string end = before.empty() || before.ends_with('\n') ? "" : "\n";
  auto provenance = AppendFile::Open(root_ / kProvenanceFile, *ops_);
  if (!provenance) return Forward(provenance);
  provenance_ = std::move(*provenance);
  status = provenance_->Append(end + PrintRunLine(run, header_, report_.kept, report_.dropped));
  if (status && !resume)
    status = WriteFileAtomic(root_ / kJournalFile, PrintJournalLine(header_), *ops_);
  if (!status) return status;
  auto journal = AppendFile::Open(root_ / kJournalFile, *ops_);
  if (!journal) return Forward(journal);
  journal_ = std::move(*journal);
  return {};
}

std::vector<PlannedFrame> SessionRecorder::Missing() const {
  std::vector<PlannedFrame> missing;
  if (ended_) return missing;
  std::copy_if(planned_.begin(), planned_.end(), std::back_inserter(missing),
               [this](const PlannedFrame& planned) { return !entries_.contains(planned.index); });
  return missing;
}

Status SessionRecorder::CheckSpace(std::uint64_t bytes, const std::string& what) const {
  const fs::path folder = ExistingFolder(root_);
  const std::int64_t free = ops_->FreeBytes(folder.c_str());
  if (free < 0) return SystemError(folder.string() + ": cannot tell the free space");
  if (static_cast<std::uint64_t>(free) >= bytes) return {};
  return SystemError(root_.string() + ": too little space for " + what + ": " +
                     ShowMegabytes(bytes) + " needed, " + std::to_string(free) + " bytes free");
}

Status SessionRecorder::CheckSpaceForMissing() const {
  const PlanEstimate estimate = EstimatePlan(setup_.plan, {}, setup_.format);
  const std::size_t missing = Missing().size();
  if (missing == 0) return {};
  return CheckSpace(missing * estimate.bytes_per_frame + kSpareBytes,
                    std::to_string(missing) + " frames");
}

std::optional<PlannedFrame> SessionRecorder::Expected(const RecordedKeyframe& keyframe) const {
  if (entries_.contains(keyframe.index)) return std::nullopt;
  if (keyframe.index < planned_.size()) return planned_[keyframe.index];
  if (keyframe.index >= planned_.size() + header_.most_extra) return std::nullopt;
  return PlannedFrame{keyframe.index, keyframe.angle_deg};
}

Status SessionRecorder::Add(const RecordedKeyframe& keyframe) {
  if (broken_) return tl::unexpected<Error>(*broken_);
  const std::optional<PlannedFrame> expected = Expected(keyframe);
  if (!expected || !journal_)
    return InputError("frame " + std::to_string(keyframe.index) +
                      ": not wanted, allowed is one that is still missing, of " +
                      std::to_string(planned_.size()));
  const PlannedFrame& planned = *expected;
  const std::string label = Label(planned);
  if (const Status status = CheckKeyframe(keyframe, setup_, label); !status) return status;
  JournalEntry entry = MakeEntry(keyframe, planned, setup_);
  const auto image = EncodeImage(root_ / entry.frame.image, keyframe.image);
  if (!image) return Forward(image);
  const auto validity = entry.frame.validity
                            ? EncodeImage(root_ / *entry.frame.validity, keyframe.validity)
                            : Result<std::string>();
  if (!validity) return Forward(validity);
  entry.frame.sha256 = Sha256Hex(*image);
  if (entry.frame.validity) entry.validity_sha256 = Sha256Hex(*validity);
  const Status space = CheckSpace(image->size() + validity->size() + kSpareBytes, label);
  // Nothing was written: it may be tried again.
  if (!space) return SystemError(space.error().text + "; " + WhenTheDiskIsWell(root_));

  Status status;
  if (entry.frame.validity)
    status = WriteFileAtomic(root_ / *entry.frame.validity, *validity, *ops_);
  if (status) status = WriteFileAtomic(root_ / entry.frame.image, *image, *ops_);
  if (status) status = provenance_->Append(PrintKeyframeLine(keyframe.provenance, entry));
  if (status) status = journal_->Append(PrintJournalLine(entry));
  if (!status) return Break(status);
  entries_.emplace(entry.index, std::move(entry));
  return {};
}

Status SessionRecorder::Finish() {
  if (broken_) return tl::unexpected<Error>(*broken_);
  if (!journal_) return InputError(root_.string() + ": the session is finished already");
  std::vector<std::string> missing;
  for (const PlannedFrame& planned : Missing()) missing.push_back(Label(planned));
  if (!missing.empty())
    return tl::unexpected<Error>(
        Error{ErrorKind::kIncomplete,
              root_.string() + ": the capture is not complete, missing are " + Listed(missing)});
  if (const Status status = WriteSessionFiles(); !status) return Break(status);
  journal_.reset();
  provenance_.reset();
  lock_.reset();
  return {};
}

Status SessionRecorder::WriteSessionFiles() {
  // Frames that were taken again stand at the journal's end; in order, it has the same bytes as if
  // nothing had happened.
  const std::string journal = PrintJournal(header_, entries_);
  if (ReadFile(root_ / kJournalFile) != journal) {
    const Status status = WriteFileAtomic(root_ / kJournalFile, journal, *ops_);
    if (!status) return status;
  }
  Session session;
  session.name = setup_.name;
  session.length_unit = setup_.length_unit;
  session.camera_path = kCaptureCameraFile;
  session.camera = setup_.camera;
  if (!setup_.calibration_text.empty())
    session.calibration = {kCaptureCalibrationFile, Sha256Hex(setup_.calibration_text)};
  session.radiometry =
      SessionRadiometry(setup_.radiometry, setup_.plan.exposures_us, setup_.plan.gain_db);
  session.bayer = setup_.bayer;
  session.target = SessionTarget(setup_);
  session.ended = ended_;
  const std::size_t closure =
      header_.closure_deg ? planned_.size() - 1 : entries_.rbegin()->first + 1;
  for (const auto& [index, entry] : entries_)
    if (index != closure) session.frames.push_back(entry.frame);
  return WriteSession(session, root_, *ops_);
}

// Adds to an error of the system what helps to go on, and holds it against every further call.
Status SessionRecorder::Break(const Status& status) {
  Error error = status.error();
  if (error.kind == ErrorKind::kSystem) {
    const std::int64_t free = ops_->FreeBytes(ExistingFolder(root_).c_str());
    error.text += "; " + (free < 0 ? "an unknown number of" : std::to_string(free)) +
                  " bytes are free in " + root_.string() + "; " + std::to_string(entries_.size()) +
                  " of " + std::to_string(planned_.size()) + " frames are safe; " +
                  WhenTheDiskIsWell(root_);
  }
  broken_ = error;
  return tl::unexpected<Error>(error);
}

}  // namespace turnlight::rig
