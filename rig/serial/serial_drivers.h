// The drivers of turntables on serial ports, of their keys: those that all have
// (serial_turntable.h), and their protocol's own. Fails (kInput) with file, line, key and what is
// allowed.
#pragma once

#include "base/result.h"
#include "base/strict_object.h"
#include "rig/driver.h"

namespace turnlight::rig::serial {

Result<TableDevice> MakeGrblTable(StrictObject keys);
Result<TableDevice> MakeZaberTable(StrictObject keys);
Result<TableDevice> MakeSmc100Table(StrictObject keys);

}  // namespace turnlight::rig::serial
