#include "app/calibrate/camera_option.h"

#include <system_error>

#include "base/file.h"
#include "base/sha256.h"
#include "base/strict_object.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxLensBytes = 64 << 20;

// What intrinsics.json knows of the intrinsics in this model's text.
Result<std::optional<Eigen::MatrixXd>> ReadIntrinsicsCovariance(const fs::path& path,
                                                                const std::string& model_text,
                                                                std::size_t count) {
  const auto text = ReadFile(path, kMaxLensBytes);
  if (!text) return Forward(text);
  const auto document = ParseJson(*text, path.string());
  if (!document) return Forward(document);
  StrictObject object(*document);
  object.AllowUnknown();
  object.Choice("format", {"turnlight-intrinsics"});
  StrictObject model = object.Object("camera_model"), intrinsics = object.Object("intrinsics");
  model.AllowUnknown();
  intrinsics.AllowUnknown();
  const std::string sha256 = model.String("sha256");
  if (model.ok() && sha256 != Sha256Hex(model_text))
    model.Refuse("sha256", "that of the camera model beside it, \"" + Sha256Hex(model_text) + "\"");
  std::optional<Eigen::MatrixXd> covariance;
  if (!intrinsics.Raw("covariance").is_null()) {
    const std::vector<double> rows = intrinsics.Matrix("covariance", count, count);
    if (intrinsics.ok())
      covariance = Eigen::Map<const Eigen::MatrixXd>(rows.data(), static_cast<Eigen::Index>(count),
                                                     static_cast<Eigen::Index>(count));
  }
  for (StrictObject* part : {&object, &model, &intrinsics})
    if (const Status status = part->Finish(); !status) return Forward(status);
  return covariance;
}

}  // namespace

Result<CalibratedLens> ReadCalibratedLens(const fs::path& path) {
  std::error_code code;
  const bool folder = fs::is_directory(path, code);
  const fs::path file = folder ? path / "camera.cameramodel" : path;
  const auto text = ReadTypedFile(file, kMaxLensBytes);
  if (!text)
    return InputError("--camera: " + text.error().text +
                      "; allowed is the folder that turnlight calibrate intrinsics wrote, or a "
                      ".cameramodel");
  auto camera = calib::CameraModel::FromString(*text, file.string());
  if (!camera) return Forward(camera);
  CalibratedLens lens{std::move(*camera), {}};
  const fs::path known = path / "intrinsics.json";
  if (!folder || !fs::exists(known, code)) return lens;
  auto covariance = ReadIntrinsicsCovariance(known, *text, lens.camera.intrinsics().size());
  if (!covariance) return Forward(covariance);
  lens.covariance = std::move(*covariance);
  return lens;
}

}  // namespace turnlight::app
