// What a camera is set to and how its pictures came, for a check-up and for the provenance.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "rig/aravis/camera_settings.h"
#include "rig/device.h"

namespace turnlight::rig::aravis {

struct ShotCounters {
  std::uint64_t triggers = 0;    // sent, with those sent again
  std::uint64_t again = 0;       // of these, sent again
  std::uint64_t broken = 0;      // pictures with lost packets
  std::uint64_t stale = 0;       // pictures that answered no trigger of ours
  std::uint64_t unanswered = 0;  // triggers without a picture in time
};

struct CameraReport {
  DeviceIdentity identity;
  std::vector<AppliedSetting> applied;
  std::vector<std::string> missing;  // optional features that it does not have
  CameraSettings settings;           // as read last
  std::string clock;                 // whose its pictures' times are
  int packet_size = 0;               // bytes; 0: not of GigE Vision
  ShotCounters shots;
  std::vector<DeviceReading> readings;  // temperature, counters of the stream and of the shots
};

}  // namespace turnlight::rig::aravis
