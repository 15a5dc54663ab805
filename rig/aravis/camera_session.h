// An open camera and its single shots. Lives on one thread, where each call may take as long as
// Aravis waits for a camera that does not answer; aravis_camera.h keeps that away from everyone
// else.
//
// A shot: take the time, trigger, and take the first picture that answers (frame_judge.h). A
// picture with lost packets is triggered again, at most five triggers in all; so is a trigger that
// is acknowledged and not answered, three in all. An acknowledgement that comes late means that
// Aravis sent the command again: the camera may take two pictures then, so all are thrown away and
// a new trigger follows.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "rig/aravis/aravis_config.h"
#include "rig/aravis/camera_report.h"
#include "rig/aravis/camera_settings.h"
#include "rig/aravis/clock_reader.h"
#include "rig/aravis/connection.h"
#include "rig/aravis/features.h"
#include "rig/aravis/frame_judge.h"
#include "rig/aravis/frame_stream.h"

namespace turnlight::rig::aravis {

struct ShotFrame {
  cv::Mat image;
  std::uint64_t id = 0;
  ExposureSpan span;
  CameraSettings actual;  // read after it
};

class CameraSession {
 public:
  // Finds the camera, applies and reads back the settings, takes a first picture to throw away, and
  // finds out what its clock is worth. A camera that was lost on the way is let go elsewhere.
  static Result<std::unique_ptr<CameraSession>> Open(const AravisConfig& config, CameraLock& lock,
                                                     std::optional<KnownCamera>& known);
  ~CameraSession();
  CameraSession(const CameraSession&) = delete;
  CameraSession& operator=(const CameraSession&) = delete;

  const DeviceIdentity& identity() const { return connection_.identity; }
  bool lost() const { return features_.lost(); }
  bool Answers();  // by a look at a register

  Result<CameraSettings> Set(const CameraSettings& settings);
  int Drain();
  Status Trigger();
  bool waiting() const { return shot_.has_value(); }
  // Goes on with the shot for at most patience, unless the camera is dead.
  Result<std::optional<ShotFrame>> Wait(std::chrono::milliseconds patience);

  std::vector<std::string> TakeNotes() { return std::exchange(notes_, {}); }
  CameraReport Report();

 private:
  struct Shot {
    SentTrigger trigger;
    int triggers = 0;
    int unanswered = 0;
    Steady::time_point deadline;
    std::optional<Steady::time_point> quiet_at;  // until then everything is thrown away
  };

  explicit CameraSession(Connection connection);
  Status Start(const AravisConfig& config, KnownCamera& known);
  Status TakeTrial();
  Result<ShotFrame> FinishTrial();
  Status CheckQuiet();
  void NoteMissing();
  Status SendTrigger();
  Status TriggerAgain(const std::string& why);
  Result<std::optional<ShotFrame>> Judge(const FrameStream::Buffer& buffer);
  Result<ShotFrame> Accept(ArvBuffer* buffer, const ArrivedFrame& arrived);
  Status CheckControl();

  Connection connection_;
  Features features_;
  SettingsRecord record_;
  ExposureControl control_;
  PixelFormat format_;
  cv::Size size_;
  std::chrono::microseconds readout_{};
  std::optional<FrameStream> stream_;
  ClockReader clock_;
  ClockSource source_ = ClockSource::kArrival;
  bool trial_ = true;
  CameraSettings settings_;
  std::optional<Shot> shot_;
  std::optional<std::uint64_t> last_id_;
  std::optional<ArrivedFrame> last_frame_;
  SentTrigger last_trigger_;
  ShotCounters counters_;
  std::string temperature_;  // its feature
  std::vector<std::string> notes_;
};

}  // namespace turnlight::rig::aravis
