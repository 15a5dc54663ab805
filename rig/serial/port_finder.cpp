#include "rig/serial/port_finder.h"

#include <libserialport.h>

#include <algorithm>
#include <filesystem>

#include "base/format.h"

namespace turnlight::rig::serial {
namespace {

namespace fs = std::filesystem;

std::string TextOf(const char* text) { return text ? text : ""; }

// The name that udev gives by the device and not by the order of plugging.
std::string StablePathOf(const std::string& path) {
  std::error_code error;
  for (const auto& link : fs::directory_iterator("/dev/serial/by-id", error)) {
    std::error_code broken;
    if (fs::equivalent(link.path(), path, broken) && !broken) return link.path();
  }
  return "";
}

PortInfo InfoOf(const sp_port* port) {
  PortInfo info;
  info.path = TextOf(sp_get_port_name(port));
  info.stable_path = StablePathOf(info.path);
  info.description = TextOf(sp_get_port_description(port));
  if (sp_get_port_transport(port) != SP_TRANSPORT_USB) return info;
  info.usb_serial = TextOf(sp_get_port_usb_serial(port));
  int vendor = 0, product = 0;
  if (sp_get_port_usb_vid_pid(port, &vendor, &product) == SP_OK)
    info.usb_ids = Format("%04x:%04x", vendor, product);
  return info;
}

std::string Described(const PortInfo& info) {
  return info.path +
         (info.usb_serial.empty() ? "" : " (USB serial number " + info.usb_serial + ")");
}

}  // namespace

std::vector<PortInfo> FindPorts() {
  sp_port** ports = nullptr;
  if (sp_list_ports(&ports) != SP_OK) return {};
  std::vector<PortInfo> found;
  for (int i = 0; ports[i]; ++i) found.push_back(InfoOf(ports[i]));
  sp_free_port_list(ports);
  std::sort(found.begin(), found.end(),
            [](const PortInfo& a, const PortInfo& b) { return a.path < b.path; });
  return found;
}

Result<std::string> FindPort(const PortChoice& choice) {
  if (choice.usb_serial.empty()) return choice.path;
  std::vector<std::string> there;
  for (const PortInfo& info : FindPorts()) {
    if (info.usb_serial == choice.usb_serial) return info.path;
    there.push_back(Described(info));
  }
  return DeviceError("no serial port with the USB serial number " + choice.usb_serial + "; " +
                     (there.empty() ? "there is none at all" : "there are " + Listed(there)));
}

std::optional<std::string> UsbSerialOf(const std::string& path) {
  std::error_code error;
  const fs::path real = fs::canonical(path, error);
  sp_port* port = nullptr;
  if (error || sp_get_port_by_name(real.c_str(), &port) != SP_OK) return std::nullopt;
  const std::string serial = InfoOf(port).usb_serial;
  sp_free_port(port);
  return serial.empty() ? std::nullopt : std::optional(serial);
}

}  // namespace turnlight::rig::serial
