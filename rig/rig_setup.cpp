#include "rig/rig_setup.h"

namespace turnlight::rig {

RigKnowledge KnowledgeOf(const RigCalibration& calibration) {
  return {calibration.lens, calibration.geometry, calibration.radiometry, calibration.noise};
}

Status OpenRig(RigSetup& rig) {
  const auto camera = rig.camera.camera->Open(DeviceTime(0));
  if (!camera) return Forward(camera);
  if (!rig.table.turntable) {  // the camera is carried by hand
    rig.identity = RigIdentity{*camera, {}};
    return {};
  }
  const auto table = rig.table.turntable->Open(DeviceTime(0));
  if (!table) return Forward(table);
  rig.identity = RigIdentity{*camera, *table};
  return rig.calibration ? CheckIdentity(*rig.calibration, *camera, *table) : Status();
}

}  // namespace turnlight::rig
