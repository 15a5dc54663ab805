// Writes a session while it grows, so that whatever happens - a crash after any step, a full disk,
// a failing fsync - the frames that are good stay good, and the capture can be resumed and ends
// with the same bytes as if nothing had happened.
//
// The folder, in the order in which things appear:
//   capture.lock         while a program writes here: who it is (base/lock_file.h)
//   camera.cameramodel, target.ply or target.obj    copies, made at the start
//   provenance.jsonl     a line per run and per keyframe: program, config, devices, times, retries.
//                        Outside every hash; the only file with times in it
//   journal.jsonl        first what was begun, then a line per keyframe that is safe on disk; each
//                        with its CRC (rig/session/journal.h). No times: it ends with the same
//                        bytes
//   frames/NNN.png|exr, frames/NNN.validity.png, frames/closure.png|exr
//   session.json         at the end, by Finish: without it, the capture is unfinished
//
// A keyframe: each picture -> temporary, write, fsync, rename, fsync of the folder; then its
// provenance line, then its journal line, each with fsync. What the journal does not name did not
// happen.
#pragma once

#include <filesystem>
#include <map>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/file.h"
#include "base/lock_file.h"
#include "base/result.h"
#include "calib/camera_model.h"
#include "calib/pose.h"
#include "calib/radiometry.h"
#include "rig/capture/capture_plan.h"
#include "rig/capture/capture_setup.h"
#include "rig/capture/provenance.h"
#include "rig/device.h"
#include "rig/session/journal.h"
#include "rig/session/session.h"

namespace turnlight::rig {

// One keyframe, as it goes into the session.
struct RecordedKeyframe {
  std::size_t index = 0;            // of PlannedFrames
  double angle_deg = 0.0;           // commanded; of extra keyframes, for the others are planned
  double angle_measured_deg = 0.0;  // unused if it was taken by hand
  calib::Pose X_WC, X_WT;
  cv::Mat image;             // MergedFrame::image: raw DN, or CV_32F of a bracket
  cv::Mat1b validity;        // MergedFrame::validity; may be empty
  calib::Exposure exposure;  // MergedFrame::exposure
  KeyframeProvenance provenance;
};

// What was found on a resume.
struct ResumeReport {
  std::size_t kept = 0;              // frames that are on disk and have their checksum
  std::vector<std::string> dropped;  // torn or damaged: one line each, with the angle if known
};

// One writer, one thread. After a write that failed every further call fails with the same error:
// what is on disk after a failed fsync nobody knows. The good frames are kept; destroy the recorder
// and Resume, in this process or another.
class SessionRecorder {
 public:
  // Takes the lock, checks the space for the whole plan, makes the folder and its first files.
  // Fails (kInput): the folder holds a session or a begun capture already, another program writes
  // here (named), a setup that makes no session. Fails (kSystem): space, disk.
  // ops outlives the recorder.
  static Result<SessionRecorder> Start(const std::filesystem::path& root, const CaptureSetup& setup,
                                       const RunProvenance& run, FileOps& ops = SystemFileOps());

  // Takes the lock, reads the journal, checks every file that it names, forgets what is torn or
  // damaged, removes temporaries. A finished session resumes to nothing missing. Fails (kInput): no
  // journal, no readable first line, another setup (the message says what differs and both values).
  static Result<SessionRecorder> Resume(const std::filesystem::path& root,
                                        const CaptureSetup& setup, const RunProvenance& run,
                                        FileOps& ops = SystemFileOps());

  // Frames of the plan that are not safe on disk yet, in order of capture; none once it ended.
  std::vector<PlannedFrame> Missing() const;
  const ResumeReport& report() const { return report_; }
  // What is safe on disk, by index.
  const std::map<std::size_t, JournalEntry>& entries() const { return entries_; }
  const std::filesystem::path& root() const { return root_; }

  // A capture with plan.until ends here: no further frame is wanted. session.json says why.
  void End(const CaptureEnd& end) { ended_ = end; }

  // The frame is safe on disk when this returns success. With plan.until the index may be one of
  // plan.until->most_extra beyond the planned ones, too. Fails (kInput): an index that is not
  // missing, a picture of another size or kind than the setup's, a validity map without a pixel, a
  // pose that is none: nothing was written, Add may go on. Fails (kSystem): too little space:
  // nothing was written, Add may go on; the disk: the text says what, where, how much is free, how
  // many frames are safe, and every further call fails.
  Status Add(const RecordedKeyframe& keyframe);

  // Writes session.json and gives the lock back. Fails (kIncomplete) if frames are missing, naming
  // their angles; the closure frame counts. Nothing is written then, and Add may go on.
  Status Finish();

 private:
  SessionRecorder(std::filesystem::path root, CaptureSetup setup, FileOps& ops);
  static Result<SessionRecorder> Open(const std::filesystem::path& root, const CaptureSetup& setup,
                                      const RunProvenance& run, FileOps& ops, bool resume);
  Status CheckFresh() const;
  Status Recover();
  Status Begin(const RunProvenance& run, bool resume);
  Status CheckSpace(std::uint64_t bytes, const std::string& what) const;
  Status CheckSpaceForMissing() const;
  // The frame that index stands for, if it is one that may come.
  std::optional<PlannedFrame> Expected(const RecordedKeyframe& keyframe) const;
  Status WriteSessionFiles();
  Status Break(const Status& status);

  std::filesystem::path root_;
  CaptureSetup setup_;
  FileOps* ops_;
  std::vector<PlannedFrame> planned_;
  JournalHeader header_;
  std::map<std::size_t, JournalEntry> entries_;
  std::optional<CaptureEnd> ended_;
  ResumeReport report_;
  std::optional<LockFile> lock_;
  std::optional<AppendFile> journal_, provenance_;
  std::optional<Error> broken_;
};

}  // namespace turnlight::rig
