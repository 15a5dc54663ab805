// What a config says of a camera behind Aravis.
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "base/result.h"
#include "base/strict_object.h"
#include "rig/aravis/pixel_format.h"

namespace turnlight::rig::aravis {

struct AravisConfig {
  std::string id;  // Aravis' id, the serial number, or an address or host name
  PixelFormat format;
  cv::Size size;                      // of the picture, as the camera counts it (binned pixels)
  std::array<int, 2> offset{0, 0};    // of its first pixel on the sensor, in the same pixels
  std::array<int, 2> binning{1, 1};   // across, down; summing or averaging as the camera does
  std::optional<double> black_level;  // in the camera's unit; left as it is if not given
  // Gain is in dB. A camera whose gain is a whole number without a unit (GainRaw) needs this for
  // other gains than 0, which is the smallest raw value.
  std::optional<double> gain_raw_step_db;
  double readout_ms = 50.0;  // from the end of an exposure to its picture, about
  // Of GigE Vision.
  std::optional<int> packet_size;  // bytes; negotiated if not given, 9000 on loopback
  bool packet_resend = true;       // asks again for lost packets
  // AF_PACKET where the system lets us (root). Takes less of the processor; what other cameras send
  // on the same interface may come in while it is set up.
  bool packet_socket = false;
  int socket_buffer_kb = 4000;
};

// The keys of docs/drivers.md. Fails (kInput) with file, line, key and what is allowed.
Result<AravisConfig> ReadAravisConfig(StrictObject keys);

}  // namespace turnlight::rig::aravis
