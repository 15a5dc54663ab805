#include "rig/serial/serial_drivers.h"

#include <memory>
#include <utility>

#include "rig/serial/grbl/grbl_protocol.h"
#include "rig/serial/serial_turntable.h"
#include "rig/serial/smc100/smc100_protocol.h"
#include "rig/serial/zaber/zaber_protocol.h"

namespace turnlight::rig::serial {
namespace {

Result<TableDevice> TableOf(StrictObject& keys, SerialKeys read,
                            std::unique_ptr<StageProtocol> protocol) {
  if (const Status status = keys.Finish(); !status) return Forward(status);
  return TableDevice{
      std::make_shared<SerialTurntable>(std::move(read.options), std::move(protocol)),
      read.kinematics, true};
}

}  // namespace

Result<TableDevice> MakeGrblTable(StrictObject keys) {
  SerialKeys read = ReadSerialKeys(keys, "grbl", 115200);
  grbl::GrblOptions options = grbl::ReadGrblOptions(keys);
  options.speed_deg_s = read.kinematics.speed_deg_per_s;
  return TableOf(keys, std::move(read), std::make_unique<grbl::GrblProtocol>(options));
}

Result<TableDevice> MakeZaberTable(StrictObject keys) {
  SerialKeys read = ReadSerialKeys(keys, "zaber", 115200);
  const zaber::ZaberOptions options = zaber::ReadZaberOptions(keys);
  return TableOf(keys, std::move(read), std::make_unique<zaber::ZaberProtocol>(options));
}

Result<TableDevice> MakeSmc100Table(StrictObject keys) {
  SerialKeys read = ReadSerialKeys(keys, "smc100", 57600);
  read.options.line.flow = FlowControl::kXonXoff;
  const smc100::Smc100Options options = smc100::ReadSmc100Options(keys);
  return TableOf(keys, std::move(read), std::make_unique<smc100::Smc100Protocol>(options));
}

}  // namespace turnlight::rig::serial
