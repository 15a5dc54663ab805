#include "app/device_list.h"

#include <nlohmann/json.hpp>

#include "base/format.h"
#include "base/printable.h"
#include "rig/serial/serial_link.h"

namespace turnlight::app {
namespace {

// As YAML takes any text.
std::string Quoted(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string PortText(const ListedPort& port, const std::vector<std::string>& drivers) {
  const rig::serial::PortInfo& info = port.info;
  std::string text = info.path;
  if (!info.description.empty()) text += "  " + info.description;
  if (!info.usb_ids.empty()) text += ", USB " + info.usb_ids;
  if (!info.usb_serial.empty()) text += ", serial number " + info.usb_serial;
  text += port.holders.empty() ? ", free" : ", held by " + port.holders;
  const std::string driver = drivers.empty() ? "DRIVER" : drivers.front();
  return "  " + Printable(text) + "\n      " + Printable(ConfigLine(info, driver)) + "\n";
}

std::string CameraText(const rig::aravis::FoundCamera& camera) {
  return "  " +
         Printable(camera.id + "  " + camera.vendor + " " + camera.model + ", serial number " +
                   camera.serial + ", at " + camera.address + " by " + camera.protocol) +
         "\n      " + Printable(ConfigLine(camera)) + "\n";
}

}  // namespace

DeviceList FindDevices(const Drivers& drivers) {
  DeviceList list;
  for (rig::serial::PortInfo& info : rig::serial::FindPorts())
    list.ports.push_back({info, rig::serial::HoldersOf(info.path)});
  for (const auto& driver : drivers.tables)
    if (!driver.simulated()) list.table_drivers.push_back(driver.name);
  auto cameras = rig::aravis::FindCameras();
  if (cameras)
    list.cameras = std::move(*cameras);
  else
    list.problems.push_back(cameras.error().text);
  return list;
}

std::string ConfigLine(const rig::serial::PortInfo& port, const std::string& driver) {
  std::string place = "port: " + port.path;
  if (!port.stable_path.empty())
    place = "port: " + port.stable_path;
  else if (!port.usb_serial.empty())
    place = "usb_serial: " + Quoted(port.usb_serial);
  return "table: {driver: " + driver + ", " + place + "}";
}

std::string ConfigLine(const rig::aravis::FoundCamera& camera) {
  return "camera: {driver: aravis, id: " + Quoted(camera.id) +
         ", pixel_format: Mono8, size: [WIDTH, HEIGHT]}";
}

std::string DeviceListText(const DeviceList& list) {
  std::string text = "serial ports\n";
  for (const ListedPort& port : list.ports) text += PortText(port, list.table_drivers);
  if (list.ports.empty())
    text +=
        "  none: is the controller switched on and plugged in? sudo dmesg shows what the system "
        "saw of it. A simulated controller has its own path, which is no port of the system\n";
  else
    text += "  the driver by the controller: " + Listed(list.table_drivers) + "\n";
  text += "cameras\n";
  for (const auto& camera : list.cameras) text += CameraText(camera);
  if (!list.cameras.empty())
    text += "  pixel_format and size as the camera's pictures are to be\n";
  else if (list.problems.empty())
    text +=
        "  none: is it powered and plugged in? A GigE Vision camera must have an address in the "
        "network of this computer's port (ip addr shows it) and UDP port 3956 must not be blocked "
        "by a firewall; a USB3 Vision camera must be one that your user may open (turnlight doctor "
        "shows the udev rule)\n";
  for (const std::string& problem : list.problems) text += "  " + Printable(problem) + "\n";
  return text;
}

std::string DeviceListJson(const DeviceList& list) {
  nlohmann::ordered_json json = {{"ports", nlohmann::ordered_json::array()},
                                 {"cameras", nlohmann::ordered_json::array()},
                                 {"problems", nlohmann::ordered_json::array()}};
  const std::string driver = list.table_drivers.empty() ? "DRIVER" : list.table_drivers.front();
  for (const ListedPort& port : list.ports)
    json["ports"].push_back({{"path", port.info.path},
                             {"stable_path", port.info.stable_path},
                             {"description", port.info.description},
                             {"usb_serial", port.info.usb_serial},
                             {"usb_ids", port.info.usb_ids},
                             {"held_by", port.holders},
                             {"config", ConfigLine(port.info, driver)}});
  for (const rig::aravis::FoundCamera& camera : list.cameras)
    json["cameras"].push_back({{"id", camera.id},
                               {"vendor", camera.vendor},
                               {"model", camera.model},
                               {"serial", camera.serial},
                               {"address", camera.address},
                               {"protocol", camera.protocol},
                               {"config", ConfigLine(camera)}});
  for (const std::string& problem : list.problems) json["problems"].push_back(problem);
  // Whatever bytes a device calls itself by.
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace turnlight::app
