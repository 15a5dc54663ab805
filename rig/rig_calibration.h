// The calibration of a rig as one file, rig-calibration.json version 1: what its pixels and angles
// mean, with units, covariances where they are known, and the devices that it belongs to.
// docs/design.md, "The rig's calibration on disk", has the format.
#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <initializer_list>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/result.h"
#include "base/strict_object.h"
#include "calib/camera_model.h"
#include "calib/radiometry.h"
#include "calib/rig_geometry.h"
#include "rig/capture/exposure_merge.h"
#include "rig/device.h"
#include "rig/driver.h"

namespace turnlight::rig {

// Which devices, set up how. Another camera, lens or region of the sensor needs another
// calibration.
struct CalibratedDevices {
  DeviceIdentity camera, table;
  cv::Size resolution;                  // of the pictures
  std::array<int, 2> roi_offset{0, 0};  // of their first pixel on the sensor, unbinned
  std::array<int, 2> binning{1, 1};
  std::string lens;  // a note for people: which lens, its focus and aperture
};

// The key identity of a calibration and of a raw capture.
Status ReadDevices(StrictObject object, CalibratedDevices& devices);
nlohmann::ordered_json PrintDevices(const CalibratedDevices& devices);

// Symmetric, with no negative variance. Of poses 6 x 6: of a rotation vector w (radians, in the
// axes of the pose's first frame) and of a shift d (length unit), as R -> Exp(w) R, t -> t + d.
struct JointCovariance {
  // Keys of the file that have a covariance of their own, in the order of the matrix.
  std::vector<std::string> of;
  Eigen::MatrixXd matrix;  // its diagonal blocks are those covariances
};
struct CalibrationCovariances {
  std::optional<Eigen::MatrixXd> camera_model;  // of the intrinsics, in their order and units
  std::optional<Eigen::MatrixXd> X_WC, X_WA, X_AT;
  std::optional<Eigen::MatrixXd> angle_scale;   // 1 x 1
  std::optional<Eigen::MatrixXd> angle_offset;  // 1 x 1, deg^2
  std::optional<Eigen::MatrixXd> radiometry;    // 2 x 2, of black and white, DN^2
  std::optional<JointCovariance> joint;         // of parts whose errors go together
  std::optional<Eigen::MatrixXd> noise;         // 2 x 2, of read_noise_dn and dn_per_electron
};

struct RigCalibration {
  explicit RigCalibration(calib::CameraModel camera) : lens(std::move(camera)) {}

  std::string length_unit = "mm";
  calib::CameraModel lens;
  calib::TurntableGeometry geometry;
  bool target_placed = true;     // false: X_AT is not known yet, and not in the file
  calib::Radiometry radiometry;  // of raw DN
  SensorNoise noise;
  CalibratedDevices devices;
  CalibrationCovariances covariances;
  // By the key of a part, the SHA-256 of the camera model that it was found with: the lens's, or
  // the part is stale. MarkFound sets it.
  std::map<std::string, std::string> found_with;
  std::string source;  // where it was read, as messages begin: "FILE" or "FILE:LINE: KEY"
};

// Reads the file and the camera model that it names, which must have its checksum. Fails (kInput)
// with file, key, value and what is allowed: besides wrong keys a file that was changed after it
// was made (sha256, which a file written by hand may leave out), and a part that was found with
// another lens, naming the command that finds it anew.
Result<RigCalibration> ReadRigCalibration(const std::filesystem::path& path);
// The same keys but format and version, as a part of a config; the camera model's path is relative
// to folder.
Result<RigCalibration> ReadRigCalibration(StrictObject object, const std::filesystem::path& folder);

// What the file is: its text, with the checksum of itself, where its lens is the file lens_path.
std::string PrintRigCalibration(const RigCalibration& calibration, const std::string& lens_path);

// Says that these parts (X_WC, X_WA, X_AT, angle_scale, angle_offset) were found with the lens as
// it is.
void MarkFound(RigCalibration& calibration, std::initializer_list<const char*> parts);

// Writes the file and beside it its lens, with the ending .cameramodel; whole or not at all. Every
// number reads back to the same bits.
Status WriteRigCalibration(const RigCalibration& calibration, const std::filesystem::path& path);

// Whether it says where the target is. Fails (kInput) naming the command that finds it.
Status CheckTargetPlaced(const RigCalibration& calibration);

// Whether it is a calibration of pictures like these, and of these devices. Fails (kInput) naming
// what differs.
Status CheckPictures(const RigCalibration& calibration, const CameraDevice& camera);
Status CheckIdentity(const RigCalibration& calibration, const DeviceIdentity& camera,
                     const DeviceIdentity& table);

}  // namespace turnlight::rig
