#include "rig/session_calibration.h"

#include <algorithm>
#include <string>
#include <utility>

#include "base/file.h"
#include "base/format.h"
#include "base/sha256.h"
#include "rig/session/session_files.h"

namespace turnlight::rig {
namespace {

// Of rotations' elements, and of translations as a share of the distance between camera and target:
// rounding of text and of another processor.
constexpr double kRounding = 1e-9;

Status CheckLens(const std::string& file, const calib::CameraModel& calibrated,
                 const calib::CameraModel& camera) {
  const auto differs = [&](const std::string& what, const std::string& was, const std::string& is) {
    return InputError(file + ": camera_model: its " + what + " is " + was +
                      ", that of the session's camera is " + is +
                      "; allowed is the calibration that the session was captured with");
  };
  const auto size = [](const calib::CameraModel& model) {
    return std::to_string(model.width()) + " x " + std::to_string(model.height());
  };
  if (size(calibrated) != size(camera))
    return differs("resolution", size(calibrated), size(camera));
  if (calibrated.lens_model() != camera.lens_model())
    return differs("lens model", calibrated.lens_model(), camera.lens_model());
  for (std::size_t i = 0; i < camera.intrinsics().size(); ++i)
    if (calibrated.intrinsics()[i] != camera.intrinsics()[i])
      return differs("intrinsic " + std::to_string(i), NumberText(calibrated.intrinsics()[i]),
                     NumberText(camera.intrinsics()[i]));
  return {};
}

// By how much two poses differ: rotations' elements, or translations as a share of a length.
double Difference(const calib::Pose& a, const calib::Pose& b, double length) {
  return std::max((a.rotation - b.rotation).cwiseAbs().maxCoeff(),
                  (a.translation - b.translation).norm() / length);
}

Status CheckPoses(const std::string& file, const RigCalibration& calibration,
                  const Session& session) {
  for (std::size_t i = 0; i < session.frames.size(); ++i) {
    const FrameRecord& frame = session.frames[i];
    const std::string key =
        (session.root / kSessionFile).string() + ": frames/" + std::to_string(i) + "/";
    const auto angle = PoseAngleDeg(frame);
    if (!angle)
      return InputError(key +
                        "angle_deg: this key is missing, a session with a calibration needs "
                        "it in every frame");
    const calib::RigPoses poses = calib::PosesAt(calibration.geometry, *angle);
    const double length =
        std::max((poses.X_WC.translation - poses.X_WT.translation).norm(), 1e-300);
    for (const auto& [name, is, was] :
         {std::tuple("X_WC", &frame.X_WC, &poses.X_WC), {"X_WT", &frame.X_WT, &poses.X_WT}}) {
      const double difference = Difference(*is, *was, length);
      if (!(difference <= kRounding))
        return InputError(key + name + ": differs by " + Format("%.2g", difference) +
                          " from the pose at " + NumberText(*angle) + " deg by " + file +
                          ", allowed is " + NumberText(kRounding) +
                          "; the calibration is another than the session's, or a pose was changed");
    }
  }
  return {};
}

}  // namespace

std::optional<double> PoseAngleDeg(const FrameRecord& frame) {
  return frame.angle_measured_deg ? frame.angle_measured_deg : frame.angle_deg;
}

Result<std::optional<RigCalibration>> ReadSessionCalibration(const Session& session) {
  if (!session.calibration) return std::optional<RigCalibration>();
  const auto file = Locate(session.root, {"calibration/path", session.calibration->path});
  if (!file) return Forward(file);
  const auto text = ReadFile(*file);
  if (!text) return Forward(text);
  if (const std::string sha256 = Sha256Hex(*text); sha256 != session.calibration->sha256)
    return InputError(file->string() + ": the file changed: its SHA-256 is " + sha256 +
                      ", calibration/sha256 of " + kSessionFile + " is " +
                      session.calibration->sha256);
  auto calibration = ReadRigCalibration(*file);
  if (!calibration) return Forward(calibration);
  if (calibration->length_unit != session.length_unit)
    return InputError(file->string() + ": length_unit: " + calibration->length_unit +
                      ", allowed is the session's, " + session.length_unit);
  Status status = CheckTargetPlaced(*calibration);
  if (status) status = CheckLens(file->string(), calibration->lens, *session.camera);
  if (status) status = CheckPoses(file->string(), *calibration, session);
  if (!status) return Forward(status);
  return std::optional(std::move(*calibration));
}

}  // namespace turnlight::rig
