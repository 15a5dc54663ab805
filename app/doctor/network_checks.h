// What the system allows a GigE Vision or USB3 Vision camera.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/doctor/check.h"
#include "app/doctor/patient.h"

namespace turnlight::app {

// Looks which camera of those that answer is the config's.
Check CheckCameraSeen(Patient& patient);
// May this user open USB3 Vision cameras, and give them memory?
Check CheckUsbAccess(Patient& patient);
Check CheckUsbMemory(Patient& patient);
// Can the system hold the packets that come while the program is busy?
Check CheckSocketBuffer(Patient& patient);
// How large may they be?
Check CheckMtu(Patient& patient);

// The same of what was found, apart from the system.
struct UsbCamera {
  std::string node;    // /dev/bus/usb/001/002
  std::string vendor;  // its USB id, "2676"
  bool allowed = false;
};
// In sys, as /sys, and dev, as /dev.
std::vector<UsbCamera> FindUsbCameras(const std::filesystem::path& sys,
                                      const std::filesystem::path& dev);
Check JudgeUsbAccess(const std::vector<UsbCamera>& cameras);
Check JudgeSocketBuffer(std::optional<long> allowed_bytes, long needed_bytes);
Check JudgeMtu(const std::string& interface, long mtu, int packet_size);

// The interface by which this computer reaches an IPv4 address; empty if by none.
std::string InterfaceTo(const std::string& address);

}  // namespace turnlight::app
