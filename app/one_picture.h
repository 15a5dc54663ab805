// One picture by a camera's trigger, proven to answer it as every picture of a capture is.
#pragma once

#include <functional>
#include <string>

#include "app/device_clock.h"
#include "base/result.h"
#include "base/stop_flag.h"
#include "nodes/messages.h"
#include "rig/device.h"

namespace turnlight::app {

// An open camera and how to wait for it.
struct Shooting {
  rig::Camera* camera = nullptr;
  const DeviceClock* clock = nullptr;
  const StopFlag* stop = nullptr;
  rig::CameraSettings settings = {};
  rig::DeviceTime patience = {};  // from the exposure's end to the picture
  int attempts = 1;               // in all, where a picture is not proven
  // For each of the camera's notes, and for each attempt that failed.
  std::function<void(const std::string&)> note = [](const std::string&) {};
};

struct Shot {
  nodes::Frame frame;
  double seconds = 0.0;  // from the trigger to the picture
  int attempts = 1;
};

// Sets exposure and gain, triggers and waits. Fails (kDevice) with what was wrong with the last
// attempt; (kInterrupted) on stop.
Result<Shot> TakePicture(const Shooting& shooting);

}  // namespace turnlight::app
