#include "rig/serial/serial_drivers.h"

#include <memory>
#include <utility>

#include "rig/serial/grbl/grbl_protocol.h"
#include "rig/serial/serial_turntable.h"

namespace turnlight::rig::serial {

Result<TableDevice> MakeGrblTable(StrictObject keys) {
  SerialKeys read = ReadSerialKeys(keys, "grbl", 115200);
  grbl::GrblOptions options = grbl::ReadGrblOptions(keys);
  options.speed_deg_s = read.kinematics.speed_deg_per_s;
  if (const Status status = keys.Finish(); !status) return Forward(status);
  return TableDevice{std::make_shared<SerialTurntable>(
                         std::move(read.options), std::make_unique<grbl::GrblProtocol>(options)),
                     read.kinematics, true};
}

}  // namespace turnlight::rig::serial
