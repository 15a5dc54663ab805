// Which serial ports are there, and which of them is meant.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/result.h"

namespace turnlight::rig::serial {

struct PortInfo {
  std::string path;         // /dev/ttyUSB0
  std::string stable_path;  // /dev/serial/by-id/...; empty if it has none
  std::string description;  // in the adapter's words
  std::string usb_serial;   // empty if it has none
  std::string usb_ids;      // "0403:6001"; empty if it is no USB device
};
// Those that libserialport knows.
std::vector<PortInfo> FindPorts();

// Which port is meant: by its path, or by the serial number of its USB adapter, which stays when
// the path changes.
struct PortChoice {
  std::string path;  // one of the two
  std::string usb_serial;
};
// The path to open now. Fails (kDevice): no such port, with those that are there.
Result<std::string> FindPort(const PortChoice& choice);

// The serial number of the USB adapter behind the path, if it has one.
std::optional<std::string> UsbSerialOf(const std::string& path);

}  // namespace turnlight::rig::serial
