#include "rig/rig_calibration.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "base/file.h"
#include "base/format.h"
#include "base/sha256.h"
#include "rig/covariance_fields.h"
#include "rig/noise_fields.h"
#include "rig/session/session_fields.h"

namespace turnlight::rig {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;
using Covariance = std::optional<Eigen::MatrixXd>;

constexpr char kFormat[] = "turnlight-rig-calibration";
constexpr std::uint64_t kMaxFileBytes = 16 << 20;

void ReadUnit(StrictObject& object, const std::string& unit) {
  if (object.String("unit") != unit && object.ok())
    object.Refuse("unit", "\"" + unit + "\", the unit of this number in this file");
}

Status ReadLens(StrictObject object, const fs::path& folder,
                std::optional<calib::CameraModel>& lens, std::string& lens_sha256,
                Covariance& covariance) {
  const std::string path = object.String("path");
  const std::string sha256 = object.String("sha256");
  if (object.ok() && !IsSha256(sha256)) object.Refuse("sha256", "64 lower-case hexadecimal digits");
  ReadUnit(object, "pixel");
  if (!object.ok()) return object.Finish();
  const auto text = ReadFile(folder / path, kMaxFileBytes);
  if (!text) return InputError(object.Where("path") + ": " + text.error().text);
  if (Sha256Hex(*text) != sha256)
    return InputError(object.Where("sha256") + ": \"" + sha256 + "\", " + (folder / path).string() +
                      " has \"" + Sha256Hex(*text) +
                      "\"; allowed is the file that the calibration was made with");
  auto model = calib::CameraModel::FromString(*text, (folder / path).string());
  if (!model) return Forward(model);
  covariance = ReadCovariance(object, static_cast<Eigen::Index>(model->intrinsics().size()));
  lens = std::move(*model);
  lens_sha256 = sha256;
  return object.Finish();
}

// The key with of a part: the lens that it was found with.
void ReadFoundWith(StrictObject& object, const std::string& key, const std::string& lens_sha256,
                   std::map<std::string, std::string>& found_with) {
  const auto with = object.OptionalString("with");
  if (!with || !object.ok()) return;
  if (!IsSha256(*with)) object.Refuse("with", "64 lower-case hexadecimal digits");
  if (*with != lens_sha256)
    object.RefuseText(
        "with", key + " was found with another lens: its camera model had the SHA-256 \"" + *with +
                    "\", camera_model/sha256 is \"" + lens_sha256 + "\"; turnlight calibrate " +
                    (key == "X_AT" ? "target" : "axis") + " finds it anew");
  found_with[key] = *with;
}

// Reads the parts of the geometry, each an object of the file.
struct PartReader {
  const std::string& lens_sha256;
  std::map<std::string, std::string>& found_with;

  Status Pose(StrictObject object, const std::string& key, const std::string& unit,
              calib::Pose& pose, Covariance& covariance) const {
    pose = ReadPose(object, "value");
    ReadUnit(object, unit);
    covariance = ReadCovariance(object, 6);
    ReadFoundWith(object, key, lens_sha256, found_with);
    return object.Finish();
  }
  Status Number(StrictObject object, const std::string& key, const std::string& unit, double& value,
                Covariance& covariance) const {
    value = object.Number("value");
    ReadUnit(object, unit);
    covariance = ReadCovariance(object, 1);
    ReadFoundWith(object, key, lens_sha256, found_with);
    return object.Finish();
  }
};

Status ReadRadiometryObject(StrictObject object, RigCalibration& calibration) {
  if (Status status = ReadRadiometry(object, calibration.radiometry); !status) return status;
  ReadUnit(object, "DN");
  if (const auto noise = object.OptionalObject("noise"))
    if (Status status = ReadSensorNoise(*noise, calibration); !status) return status;
  calibration.covariances.radiometry = ReadCovariance(object, 2);
  return object.Finish();
}

DeviceIdentity ReadDevice(StrictObject& object) {
  DeviceIdentity device;
  device.vendor = object.String("vendor");
  device.model = object.String("model");
  device.serial = object.String("serial");
  return device;
}

std::array<int, 2> ReadPair(StrictObject& object, const char* key, double min,
                            std::array<int, 2> value) {
  const auto pair = object.OptionalNumbers(key, 2, {.min = min, .max = 65536.0});
  if (!pair) return value;
  for (std::size_t i = 0; i < 2; ++i) value[i] = static_cast<int>((*pair)[i]);
  if (value[0] != (*pair)[0] || value[1] != (*pair)[1])
    object.Refuse(key, "a list of 2 whole numbers");
  return value;
}

}  // namespace

Status ReadDevices(StrictObject object, CalibratedDevices& devices) {
  StrictObject camera = object.Object("camera"), table = object.Object("table");
  devices.lens = object.OptionalString("lens").value_or("");
  if (Status status = object.Finish(); !status) return status;
  devices.camera = ReadDevice(camera);
  camera.Numbers("resolution", 2);  // it must be there
  const auto size = ReadPair(camera, "resolution", 1.0, {1, 1});
  devices.resolution = {size[0], size[1]};
  devices.roi_offset = ReadPair(camera, "roi_offset", 0.0, devices.roi_offset);
  devices.binning = ReadPair(camera, "binning", 1.0, devices.binning);
  if (Status status = camera.Finish(); !status) return status;
  devices.table = ReadDevice(table);
  return table.Finish();
}

namespace {

// What the parts say together.
Status CheckTogether(const RigCalibration& calibration) {
  if (calibration.geometry.angle_scale == 0.0)
    return InputError(calibration.source + ": angle_scale/value: 0, allowed is any other number");
  const cv::Size size(calibration.lens.width(), calibration.lens.height());
  const cv::Size& resolution = calibration.devices.resolution;
  if (resolution == size) return {};
  return InputError(calibration.source +
                    ": identity/camera/resolution: " + std::to_string(resolution.width) + " x " +
                    std::to_string(resolution.height) + ", allowed is the camera model's, " +
                    std::to_string(size.width) + " x " + std::to_string(size.height));
}

Status ReadJoint(StrictObject object, CalibrationCovariances& known) {
  auto joint = ReadJointCovariance(std::move(object), known);
  if (!joint) return Forward(joint);
  known.joint = std::move(*joint);
  return {};
}

Result<RigCalibration> ReadKeys(StrictObject& object, const fs::path& folder) {
  const std::string unit = object.OptionalString("length_unit").value_or("mm");
  if (!IsWord(unit)) object.Refuse("length_unit", "a word without spaces, such as \"mm\"");
  StrictObject camera_model = object.Object("camera_model"), X_WC = object.Object("X_WC"),
               X_WA = object.Object("X_WA"), scale = object.Object("angle_scale"),
               offset = object.Object("angle_offset"), radiometry = object.Object("radiometry"),
               identity = object.Object("identity");
  const auto X_AT = object.OptionalObject("X_AT"),
             joint = object.OptionalObject("joint_covariance");
  Status status = object.Finish();
  std::optional<calib::CameraModel> lens;
  std::string lens_sha256;
  CalibrationCovariances sigma;
  if (status) status = ReadLens(camera_model, folder, lens, lens_sha256, sigma.camera_model);
  if (!status) return Forward(status);
  RigCalibration calibration(std::move(*lens));
  calibration.length_unit = unit;
  calibration.covariances = std::move(sigma);
  calibration.source = object.Where("");
  CalibrationCovariances& known = calibration.covariances;
  calib::TurntableGeometry& geometry = calibration.geometry;
  const PartReader read{lens_sha256, calibration.found_with};
  status = read.Pose(X_WC, "X_WC", unit, geometry.X_WC, known.X_WC);
  if (status) status = read.Pose(X_WA, "X_WA", unit, geometry.X_WA, known.X_WA);
  calibration.target_placed = X_AT.has_value();
  if (status && X_AT) status = read.Pose(*X_AT, "X_AT", unit, geometry.X_AT, known.X_AT);
  if (status)
    status = read.Number(scale, "angle_scale", "deg/deg", geometry.angle_scale, known.angle_scale);
  if (status)
    status =
        read.Number(offset, "angle_offset", "deg", geometry.angle_offset_deg, known.angle_offset);
  if (status) status = ReadRadiometryObject(radiometry, calibration);
  if (status) status = ReadDevices(identity, calibration.devices);
  if (status && joint) status = ReadJoint(*joint, known);
  if (status) status = CheckTogether(calibration);
  if (!status) return Forward(status);
  return calibration;
}

// The checksum of a file, of the text in which nlohmann::json prints all its keys but this one,
// sorted and without spaces: so it is the same however the file is laid out.
std::string ContentSha256(nlohmann::json root) {
  root.erase("sha256");
  return Sha256Hex(root.dump());
}

ordered_json PrintPart(const RigCalibration& calibration, const std::string& key,
                       ordered_json value, const std::string& unit, const Covariance& covariance) {
  ordered_json object{{"value", std::move(value)}, {"unit", unit}};
  AddCovariance(object, covariance);
  const auto with = calibration.found_with.find(key);
  if (with != calibration.found_with.end()) object["with"] = with->second;
  return object;
}

ordered_json PrintRadiometryObject(const RigCalibration& calibration) {
  const calib::Radiometry& radiometry = calibration.radiometry;
  ordered_json object = PrintRadiometryCore(radiometry);
  if (radiometry.reference_exposure_us)
    object["reference_exposure_us"] = *radiometry.reference_exposure_us;
  if (radiometry.reference_gain_db) object["reference_gain_db"] = *radiometry.reference_gain_db;
  object["white_balance"] = radiometry.white_balance;
  object["unit"] = "DN";
  if (radiometry.vignetting) object["vignetting"] = PrintVignetting(*radiometry.vignetting);
  if (const auto noise = PrintSensorNoise(calibration)) object["noise"] = *noise;
  AddCovariance(object, calibration.covariances.radiometry);
  return object;
}

ordered_json PrintDevice(const DeviceIdentity& device) {
  return {{"vendor", device.vendor}, {"model", device.model}, {"serial", device.serial}};
}

}  // namespace

ordered_json PrintDevices(const CalibratedDevices& devices) {
  ordered_json camera = PrintDevice(devices.camera);
  camera["resolution"] = std::array{devices.resolution.width, devices.resolution.height};
  camera["roi_offset"] = devices.roi_offset;
  camera["binning"] = devices.binning;
  return {{"camera", camera}, {"table", PrintDevice(devices.table)}, {"lens", devices.lens}};
}

std::string PrintRigCalibration(const RigCalibration& calibration, const std::string& lens_path) {
  const calib::TurntableGeometry& geometry = calibration.geometry;
  const CalibrationCovariances& known = calibration.covariances;
  const std::string& unit = calibration.length_unit;
  ordered_json lens{
      {"path", lens_path}, {"sha256", Sha256Hex(calibration.lens.ToString())}, {"unit", "pixel"}};
  AddCovariance(lens, known.camera_model);
  const auto part = [&](const char* key, ordered_json value, const std::string& in,
                        const Covariance& covariance) {
    return std::pair(key, PrintPart(calibration, key, std::move(value), in, covariance));
  };
  std::vector<std::pair<const char*, ordered_json>> parts = {
      {"format", kFormat},
      {"version", 1},
      {"length_unit", unit},
      {"camera_model", lens},
      part("X_WC", PrintPose(geometry.X_WC), unit, known.X_WC),
      part("X_WA", PrintPose(geometry.X_WA), unit, known.X_WA),
      part("angle_scale", geometry.angle_scale, "deg/deg", known.angle_scale),
      part("angle_offset", geometry.angle_offset_deg, "deg", known.angle_offset),
      {"radiometry", PrintRadiometryObject(calibration)},
      {"identity", PrintDevices(calibration.devices)}};
  if (calibration.target_placed)
    parts.insert(parts.begin() + 6, part("X_AT", PrintPose(geometry.X_AT), unit, known.X_AT));
  if (known.joint) parts.emplace_back("joint_covariance", PrintJointCovariance(*known.joint));
  ordered_json rest;
  for (const auto& [key, value] : parts) rest[key] = value;
  parts.emplace_back("sha256", ContentSha256(rest));
  std::string text;
  for (const auto& [key, value] : parts)
    text += (text.empty() ? "{\n \"" : ",\n \"") + std::string(key) + "\": " + value.dump();
  return text + "\n}\n";
}

void MarkFound(RigCalibration& calibration, std::initializer_list<const char*> parts) {
  const std::string sha256 = Sha256Hex(calibration.lens.ToString());
  for (const char* part : parts) calibration.found_with[part] = sha256;
}

namespace {

// Beyond the pixels' range nothing would ever count as clipped; far below it nearly all would.
Status CheckFullScale(const RigCalibration& calibration, const CameraDevice& camera) {
  const double saturation = calibration.radiometry.SaturationDn();
  if (!camera.full_scale_dn ||
      (saturation >= camera.full_scale_dn->front() && saturation <= camera.full_scale_dn->back()))
    return {};
  return InputError(calibration.source + ": radiometry/" +
                    (calibration.radiometry.saturation ? "saturation" : "white") + ": " +
                    NumberText(saturation) +
                    ", a full pixel of this config's camera reads at most " +
                    NumberText(camera.full_scale_dn->back()) + "; allowed is " +
                    NumberText(camera.full_scale_dn->front()) + ".." +
                    NumberText(camera.full_scale_dn->back()) + ", or another pixel_format");
}

std::string ShowPair(int a, int b) { return std::to_string(a) + " x " + std::to_string(b); }

}  // namespace

Result<RigCalibration> ReadRigCalibration(const fs::path& path) {
  const auto text = ReadTypedFile(path, kMaxFileBytes);
  if (!text) return Forward(text);
  const auto document = ParseJson(*text, path.string());
  if (!document) return Forward(document);
  StrictObject object(*document);
  object.Choice("format", {kFormat});
  if (object.Integer("version", INT64_MIN, INT64_MAX) != 1 && object.ok())
    object.Refuse("version", "1, the version that this program reads");
  if (!object.ok()) return Forward(object.Finish());
  const auto sha256 = object.OptionalString("sha256");
  auto calibration = ReadKeys(object, path.parent_path());
  if (!calibration || !sha256) return calibration;
  const std::string is = ContentSha256(document->root);
  if (is == *sha256) return calibration;
  return InputError(object.Where("sha256") + ": \"" + *sha256 +
                    "\", of the rest of the file it is \"" + is +
                    "\": the file was changed after it was made; if that was meant, remove "
                    "the key sha256, else calibrate anew or take back the file as it was made");
}

Result<RigCalibration> ReadRigCalibration(StrictObject object, const fs::path& folder) {
  return ReadKeys(object, folder);
}

Status WriteRigCalibration(const RigCalibration& calibration, const fs::path& path) {
  const std::string lens = calibration.lens.ToString();
  const fs::path lens_path = fs::path(path).replace_extension(".cameramodel");
  if (Status status = WriteFileAtomic(lens_path, lens); !status) return status;
  return WriteFileAtomic(path, PrintRigCalibration(calibration, lens_path.filename().string()));
}

Status CheckTargetPlaced(const RigCalibration& calibration) {
  if (calibration.target_placed) return {};
  return InputError(calibration.source +
                    ": X_AT: this key is missing, as the target's place on the table is not "
                    "calibrated yet; turnlight calibrate target finds it");
}

Status CheckPictures(const RigCalibration& calibration, const CameraDevice& camera) {
  const CalibratedDevices& made = calibration.devices;
  const cv::Size& size = camera.format.size;
  const std::pair<const char*, std::pair<std::string, std::string>> parts[] = {
      {"resolution",
       {ShowPair(made.resolution.width, made.resolution.height),
        ShowPair(size.width, size.height)}},
      {"roi_offset",
       {ShowPair(made.roi_offset[0], made.roi_offset[1]),
        ShowPair(camera.roi_offset[0], camera.roi_offset[1])}},
      {"binning",
       {ShowPair(made.binning[0], made.binning[1]),
        ShowPair(camera.binning[0], camera.binning[1])}}};
  for (const auto& [key, values] : parts)
    if (values.first != values.second)
      return InputError(calibration.source + ": identity/camera/" + key + ": " + values.first +
                        ", this config's camera gives " + values.second +
                        "; allowed is a calibration made with these pictures");
  if (!made.lens.empty() && !camera.lens.empty() && made.lens != camera.lens)
    return InputError(calibration.source + ": identity/lens: \"" + made.lens +
                      "\", this config's rig/camera/lens is \"" + camera.lens +
                      "\"; allowed is a calibration made with this lens, as it is set now");
  return CheckFullScale(calibration, camera);
}

Status CheckIdentity(const RigCalibration& calibration, const DeviceIdentity& camera,
                     const DeviceIdentity& table) {
  const CalibratedDevices& made = calibration.devices;
  const auto check = [&](const std::string& key, const DeviceIdentity& was,
                         const DeviceIdentity& is) -> Status {
    const std::pair<const char*, std::pair<std::string, std::string>> parts[] = {
        {"vendor", {was.vendor, is.vendor}},
        {"model", {was.model, is.model}},
        {"serial", {was.serial, is.serial}}};
    for (const auto& [name, values] : parts)
      if (values.first != values.second)
        return InputError(calibration.source + ": identity/" + key + "/" + name + ": \"" +
                          values.first + "\", the " + key + " that was opened says \"" +
                          values.second + "\"; allowed is a calibration of these devices");
    return {};
  };
  if (Status status = check("camera", made.camera, camera); !status) return status;
  return check("table", made.table, table);
}

}  // namespace turnlight::rig
