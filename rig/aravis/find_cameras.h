// Which cameras there are.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"

namespace turnlight::rig::aravis {

struct FoundCamera {
  std::string id;  // of Aravis; what `id` in a config may name, as serial and address
  std::string vendor, model, serial;
  std::string address;   // IPv4 of GigE Vision; of USB3 Vision what Aravis says
  std::string protocol;  // "GigEVision", "USB3Vision"
};

// Asks the networks and the USB ports; takes about a second. Fails (kDevice) if that is not over
// within patience.
Result<std::vector<FoundCamera>> FindCameras(
    std::chrono::milliseconds patience = std::chrono::milliseconds(5000));

// The camera that a config's id means: that of the id, else of the serial number, else of the
// address.
std::optional<FoundCamera> CameraOf(const std::vector<FoundCamera>& cameras, const std::string& id);

// "seen were A (serial S, at 10.0.0.2), B ...", or that none was seen.
std::string DescribeCameras(const std::vector<FoundCamera>& cameras);

}  // namespace turnlight::rig::aravis
