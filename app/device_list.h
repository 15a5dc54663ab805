// What is plugged in, with the lines that name it in a config.
#pragma once

#include <string>
#include <vector>

#include "app/drivers.h"
#include "rig/aravis/find_cameras.h"
#include "rig/serial/port_finder.h"

namespace turnlight::app {

struct ListedPort {
  rig::serial::PortInfo info;
  std::string holders;  // programs that have it open; empty if none is seen
};

struct DeviceList {
  std::vector<ListedPort> ports;
  std::vector<rig::aravis::FoundCamera> cameras;
  std::vector<std::string> problems;       // a search that failed
  std::vector<std::string> table_drivers;  // that a port may be named with
};
// Looks for a few seconds at most.
DeviceList FindDevices(const Drivers& drivers);

// "table: {driver: grbl, port: ...}", to be put under `rig:`.
std::string ConfigLine(const rig::serial::PortInfo& port, const std::string& driver);
// "camera: {driver: aravis, id: ...}", with its format and size still to be filled in.
std::string ConfigLine(const rig::aravis::FoundCamera& camera);

std::string DeviceListText(const DeviceList& list);
// {"ports": [{path, stable_path, description, usb_serial, usb_ids, held_by, config}], "cameras":
// [{id, vendor, model, serial, address, protocol, config}], "problems": [...]}.
std::string DeviceListJson(const DeviceList& list);

}  // namespace turnlight::app
