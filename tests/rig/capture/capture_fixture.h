// A capture of four tiny keyframes and a closure frame, bracketed, of a mesh target; and a disk
// that fails, or ends the process, at the n-th call. For the tests of the recorder.
#pragma once

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include "rig/capture/exposure_merge.h"
#include "rig/capture/session_recorder.h"
#include "tests/rig/session/fixture.h"

namespace turnlight::rig {

// Counts the calls that change a disk; does something else at one of them. Does not wait for the
// disk: the crashes here are those of a process.
class FaultyOps : public FileOps {
 public:
  enum class Fault {
    kNone,
    kError,        // the call fails with EIO and does nothing
    kNoSpace,      // a write writes half of it, and the next fails; other calls fail
    kShortWrite,   // a write writes half of it, and nothing else happens
    kCrash,        // the process ends after the call
    kCrashInside,  // the process ends in the middle of a write
  };
  explicit FaultyOps(Fault fault = Fault::kNone, int at = 0) : fault_(fault), at_(at) {}

  int calls() const { return calls_; }
  const std::string& failed() const { return failed_; }  // the call that failed
  std::int64_t free_bytes = std::int64_t{1} << 40;
  // What happened, such as "write PATH".
  std::vector<std::string> trace;

  int Open(const char* path, int flags, mode_t mode) override {
    return Step<int>("open", path, [&] {
      const int fd = FileOps::Open(path, flags, mode);
      paths_[fd] = path;
      return fd;
    });
  }
  int MakeTemporary(char* name) override {
    return Step<int>("create", name, [&] {
      const int fd = FileOps::MakeTemporary(name);
      paths_[fd] = name;
      return fd;
    });
  }
  ssize_t Write(int fd, const void* data, std::size_t size) override {
    if (full_) {
      errno = ENOSPC;
      return -1;
    }
    if (fault_ == Fault::kNoSpace || fault_ == Fault::kShortWrite ||
        fault_ == Fault::kCrashInside) {
      if (++calls_ != at_) return FileOps::Write(fd, data, size);
      const ssize_t half = FileOps::Write(fd, data, size / 2);
      if (fault_ == Fault::kCrashInside) ::_exit(137);
      full_ = fault_ == Fault::kNoSpace;
      failed_ = full_ ? "write" : "";
      return half;
    }
    return Step<ssize_t>("write", paths_[fd], [&] { return FileOps::Write(fd, data, size); });
  }
  int Truncate(int fd, off_t size) override {
    return Step<int>("truncate", paths_[fd], [&] { return FileOps::Truncate(fd, size); });
  }
  int ChangeMode(int fd, mode_t mode) override {
    return Step<int>("mode", paths_[fd], [&] { return FileOps::ChangeMode(fd, mode); });
  }
  int Sync(int fd) override {
    return Step<int>("sync", paths_[fd], [] { return 0; });
  }
  int Close(int fd) override {
    const std::string path = paths_[fd];
    const int result = Step<int>("close", path, [] { return 0; });
    const int reason = errno;
    FileOps::Close(fd);  // a failed close closes, too
    errno = reason;
    return result;
  }
  int Lock(int fd) override {
    return Step<int>("lock", paths_[fd], [&] { return FileOps::Lock(fd); });
  }
  int Rename(const char* from, const char* to) override {
    return Step<int>("rename", to, [&] { return FileOps::Rename(from, to); });
  }
  int Unlink(const char* path) override {
    return Step<int>("unlink", path, [&] { return FileOps::Unlink(path); });
  }
  int MakeFolder(const char* path) override {
    return Step<int>("mkdir", path, [&] { return FileOps::MakeFolder(path); });
  }
  std::int64_t FreeBytes(const char*) override { return free_bytes; }

 private:
  template <typename T, typename Call>
  T Step(const char* name, const std::string& path, Call call) {
    const bool now = ++calls_ == at_;
    if (now && (fault_ == Fault::kError || fault_ == Fault::kNoSpace)) {
      failed_ = name;
      errno = fault_ == Fault::kError ? EIO : ENOSPC;
      return -1;
    }
    const T result = call();
    trace.push_back(std::string(name) + " " + path);
    if (now && (fault_ == Fault::kCrash || fault_ == Fault::kCrashInside)) ::_exit(137);
    return result;
  }

  Fault fault_;
  int at_;
  int calls_ = 0;
  bool full_ = false;
  std::string failed_;
  std::map<int, std::string> paths_;
};

class CaptureFixture : public testing::Test {
 protected:
  CaptureFixture() : setup_{MakeSetup()} {
    const auto raw = RawRadiometry(setup_.radiometry, setup_.plan.exposures_us, 0.0);
    for (const PlannedFrame& planned : PlannedFrames(setup_.plan)) {
      cv::Mat one(kHeight, kWidth, CV_16UC3);
      cv::RNG(static_cast<std::uint64_t>(planned.index) + 1).fill(one, cv::RNG::UNIFORM, 1, 65536);
      const cv::Mat two = one / 4;
      const auto merged = MergeExposures({{one, {8000.0, 0.0}}, {two, {2000.0, 0.0}}}, raw, {});
      RecordedKeyframe keyframe;
      keyframe.index = planned.index;
      keyframe.angle_measured_deg = planned.angle_deg + 0.01;
      keyframe.X_WC.translation = {0.0, 0.0, -300.0};
      const Eigen::AngleAxisd turn(planned.angle_deg / 57.3, Eigen::Vector3d::UnitZ());
      keyframe.X_WT.rotation = turn.toRotationMatrix();
      keyframe.image = merged->image;
      keyframe.validity = merged->validity;
      keyframe.exposure = merged->exposure;
      keyframe.provenance.utc = "2024-05-01T00:00:00Z";
      keyframes_.push_back(keyframe);
    }
  }

  CaptureSetup MakeSetup() const {
    CapturePlan plan;
    plan.count = 3;
    plan.closure = true;
    plan.exposures_us = {8000.0, 2000.0};
    calib::Radiometry radiometry;
    radiometry.white = 65535.0;
    return {.plan = plan,
            .config_text = "plan: {count: 3}  # a comment\n",
            .name = "small",
            .length_unit = "mm",
            .camera = calib::CameraModel::Pinhole(kWidth, kHeight, 20.0, 20.0, 7.5, 5.5),
            .calibration_text = "",
            .radiometry = radiometry,
            .bayer = std::nullopt,
            .target = MeshCopy{MeshFormat::kObj, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"},
            .format = {{kWidth, kHeight}, 3, CV_16U},
            .camera_identity = "Maker, C, 77",
            .table_identity = "Maker, T, 5"};
  }

  RunProvenance Run() {
    RunProvenance run{"1.2.3",
                      "abcdef",
                      "2024-05-0" + std::to_string(++runs_ % 9) + "T00:00:00Z",
                      {},
                      {{"packet_size", "9000"}}};
    return run;
  }

  // Starts the capture, or goes on with it, and takes what is missing. added counts the keyframes
  // that the recorder said are safe.
  Status Capture(const std::filesystem::path& root, FileOps& ops, std::size_t* added = nullptr) {
    const bool begun = std::filesystem::exists(root / kJournalFile);
    auto recorder = begun ? SessionRecorder::Resume(root, setup_, Run(), ops)
                          : SessionRecorder::Start(root, setup_, Run(), ops);
    if (!recorder) return Forward(recorder);
    for (const PlannedFrame& planned : recorder->Missing()) {
      const Status status = recorder->Add(keyframes_[planned.index]);
      if (!status) return status;
      if (added) ++*added;
    }
    return recorder->Finish();
  }
  Status Capture(const std::filesystem::path& root) {
    FaultyOps quick;  // a thousand captures do not wait for the disk
    return Capture(root, quick);
  }

  // Every file's bytes by path; of the provenance only that it is there: it holds times.
  static std::map<std::string, std::string> Contents(const std::filesystem::path& root) {
    std::map<std::string, std::string> contents;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
      const std::string name = std::filesystem::relative(entry.path(), root).string();
      if (entry.is_regular_file())
        contents[name] = name == kProvenanceFile ? "" : ReadFile(entry.path()).value();
    }
    return contents;
  }

  TemporaryFolder folder_;
  CaptureSetup setup_;
  std::vector<RecordedKeyframe> keyframes_;
  int runs_ = 0;
};

}  // namespace turnlight::rig
