// A rig, ready to capture with: one value with all that a capture, a plan and a graph need to know
// of it, whatever its devices are.
#pragma once

#include <optional>
#include <string>

#include "base/result.h"
#include "calib/camera_model.h"
#include "calib/radiometry.h"
#include "calib/rig_geometry.h"
#include "calib/target_shape.h"
#include "rig/capture/capture_setup.h"
#include "rig/capture/exposure_merge.h"
#include "rig/driver.h"
#include "rig/rig_calibration.h"

namespace turnlight::rig {

// What pixels and angles mean: from the rig's calibration, or from the simulation itself.
struct RigKnowledge {
  calib::CameraModel lens;
  calib::RigGeometry geometry;
  calib::Radiometry radiometry;  // of raw DN; with a reference exposure if brackets are merged
  SensorNoise noise;
};
RigKnowledge KnowledgeOf(const RigCalibration& calibration);

struct RigTarget {
  calib::TargetShape shape;
  CaptureTarget copy;  // for the session
};

struct RigIdentity {
  DeviceIdentity camera, table;  // the table's empty if there is none
};

struct RigSetup {
  TableDevice table;  // its turntable null: the camera is carried by hand, known.geometry unused
  CameraDevice camera;
  std::string length_unit = "mm";
  RigKnowledge known;
  RigTarget target;
  std::optional<RigCalibration> calibration;  // if one was named: of the devices to be opened
  std::optional<std::string> truth;           // truth.json, of a simulated rig only
  std::optional<RigIdentity> identity;        // once the devices are open
};

// Opens the devices and learns who they are. Fails (kDevice) with a device's name, or (kInput) if
// the calibration is of others.
Status OpenRig(RigSetup& rig);

}  // namespace turnlight::rig
