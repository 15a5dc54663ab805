// The serial port of the table, before it is opened.
#pragma once

#include <optional>
#include <string>

#include "app/doctor/check.h"
#include "app/doctor/patient.h"
#include "rig/serial/port_finder.h"

namespace turnlight::app {

// May this user open it?
Check CheckPortAccess(Patient& patient);
// Does another program have it open?
Check CheckPortHolder(Patient& patient);
// Will it have the same name tomorrow?
Check CheckPortName(Patient& patient);

// The same of what was found, apart from the system.
struct PortAccess {
  std::string path;
  bool there = false, allowed = false;
  bool group_may = false;             // read and write it
  std::string group = {}, user = {};  // of the port; of this program
};
Check JudgePortAccess(const PortAccess& access);
// named: as the config says it. info: of the system, if it knows the port.
Check JudgePortName(const std::string& named, const std::optional<rig::serial::PortInfo>& info);

}  // namespace turnlight::app
