#include "rig/capture/capture_setup.h"

#include "base/sha256.h"
#include "rig/session/mesh_file.h"

namespace turnlight::rig {
namespace {

std::string PathOf(const MeshCopy& mesh) {
  return mesh.format == MeshFormat::kPly ? "target.ply" : "target.obj";
}

bool IsBracket(const CaptureSetup& setup) { return setup.plan.exposures_us.size() > 1; }

}  // namespace

std::string Describe(const DeviceIdentity& device) {
  return device.vendor + ", " + device.model + ", " + device.serial;
}

int StoredDepth(const CaptureSetup& setup) {
  return IsBracket(setup) ? CV_32F : setup.format.depth;
}

Status CheckSetup(const CaptureSetup& setup) {
  const std::string begin = "capture: ";
  if (const auto problem = Validate(setup.plan))
    return InputError(begin + problem->key + ": " + problem->text);
  if (setup.format.size != cv::Size(setup.camera.width(), setup.camera.height()))
    return InputError(
        begin + "the camera gives pictures of " + std::to_string(setup.format.size.width) + " x " +
        std::to_string(setup.format.size.height) + " pixels, its model is of " +
        std::to_string(setup.camera.width()) + " x " + std::to_string(setup.camera.height()) +
        "; allowed is the model of this camera at this resolution");
  const int depth = setup.format.depth;
  if ((setup.format.channels != 1 && setup.format.channels != 3) ||
      (depth != CV_8U && depth != CV_16U && depth != CV_32F))
    return InputError(begin + "pictures of " + std::to_string(setup.format.channels) +
                      " channels of type " + cv::depthToString(depth) +
                      ", allowed are 1 or 3 of 8 or 16 bits or float");
  if (const auto* mesh = std::get_if<MeshCopy>(&setup.target))
    if (const auto parsed = ParseMesh(mesh->bytes, PathOf(*mesh)); !parsed) return Forward(parsed);
  if (!IsBracket(setup)) return {};
  if (setup.bayer)
    return InputError(begin + "exposures_us: a bracket of " +
                      std::to_string(setup.plan.exposures_us.size()) +
                      " exposures with a Bayer camera, allowed is one: a mosaic cannot be merged");
  if (setup.radiometry.encoding != calib::Encoding::kLinear)
    return InputError(begin + "exposures_us: a bracket needs radiometry/encoding linear");
  return {};
}

std::vector<std::pair<std::string, std::string>> CopiesOf(const CaptureSetup& setup) {
  std::vector<std::pair<std::string, std::string>> copies{
      {kCaptureCameraFile, setup.camera.ToString()}};
  if (!setup.calibration_text.empty())
    copies.emplace_back(kCaptureCalibrationFile, setup.calibration_text);
  if (const auto* mesh = std::get_if<MeshCopy>(&setup.target))
    copies.emplace_back(PathOf(*mesh), mesh->bytes);
  return copies;
}

Target SessionTarget(const CaptureSetup& setup) {
  if (const auto* sphere = std::get_if<calib::SphereShape>(&setup.target)) return *sphere;
  if (const auto* plane = std::get_if<calib::PlaneShape>(&setup.target)) return *plane;
  return MeshFile{PathOf(std::get<MeshCopy>(setup.target))};
}

JournalHeader MakeHeader(const CaptureSetup& setup) {
  JournalHeader header;
  header.config_text = setup.config_text;
  header.camera_path = kCaptureCameraFile;
  header.camera_sha256 = Sha256Hex(setup.camera.ToString());
  if (const auto* mesh = std::get_if<MeshCopy>(&setup.target)) {
    header.mesh_path = PathOf(*mesh);
    header.mesh_sha256 = Sha256Hex(mesh->bytes);
  }
  header.camera_identity = setup.camera_identity;
  header.table_identity = setup.table_identity;
  header.by_hand = setup.plan.by_hand;
  if (setup.plan.until) header.most_extra = static_cast<std::size_t>(setup.plan.until->most_extra);
  for (const PlannedFrame& planned : PlannedFrames(setup.plan)) {
    if (planned.closure)
      header.closure_deg = planned.angle_deg;
    else
      header.angles_deg.push_back(planned.angle_deg);
  }
  return header;
}

}  // namespace turnlight::rig
