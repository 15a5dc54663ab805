// What is captured and with what, before the first frame: the same for every run of one capture.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "base/result.h"
#include "calib/camera_model.h"
#include "calib/radiometry.h"
#include "calib/target_shape.h"
#include "rig/capture/capture_plan.h"
#include "rig/device.h"
#include "rig/session/journal.h"
#include "rig/session/session.h"

namespace turnlight::rig {

// Of the lens, in the session's folder.
inline constexpr char kCaptureCameraFile[] = "camera.cameramodel";
// Of the rig's calibration there, whose lens that is.
inline constexpr char kCaptureCalibrationFile[] = "rig-calibration.json";

// A mesh as the session will hold it: target.ply or target.obj.
enum class MeshFormat { kPly, kObj };
struct MeshCopy {
  MeshFormat format = MeshFormat::kPly;
  std::string bytes;  // of the file
};
using CaptureTarget = std::variant<calib::SphereShape, calib::PlaneShape, MeshCopy>;

// "vendor, model, serial", as journal and provenance name a device.
std::string Describe(const DeviceIdentity& device);

// What is captured and with what. The same for every run of one capture: a resume with another
// config, camera model, mesh or device (vendor, model, serial) is refused.
struct CaptureSetup {
  CapturePlan plan;         // valid
  std::string config_text;  // of the config file, as read
  std::string name;         // of the session
  std::string length_unit = "mm";
  calib::CameraModel camera;
  std::string calibration_text;      // of the session's copy; empty: the rig has none
  calib::Radiometry radiometry;      // of raw DN; the session's is SessionRadiometry of it
  std::optional<std::string> bayer;  // refused together with a bracket
  CaptureTarget target;
  PictureFormat format;
  std::string camera_identity, table_identity;  // Describe of the devices
};

// Fails (kInput): a plan that is none, a picture format that is not the camera model's, a bracket
// of what cannot be merged, a damaged mesh.
Status CheckSetup(const CaptureSetup& setup);

// The depth of the pictures that are kept: a bracket is merged to floats.
int StoredDepth(const CaptureSetup& setup);
// The files that are in the session's folder from the start, by name.
std::vector<std::pair<std::string, std::string>> CopiesOf(const CaptureSetup& setup);
// The target as the session names it.
Target SessionTarget(const CaptureSetup& setup);
// The journal's first line.
JournalHeader MakeHeader(const CaptureSetup& setup);

}  // namespace turnlight::rig
