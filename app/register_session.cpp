#include "app/register_session.h"

#include "app/calibrate/picture_files.h"
#include "app/output_folder.h"
#include "base/file.h"
#include "base/format.h"
#include "base/sha256.h"
#include "rig/session/image_file.h"
#include "rig/session/mesh_file.h"
#include "rig/session/session.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;

Result<rig::FrameRecord> CopyPicture(const HandheldSession& session, std::size_t index,
                                     const fs::path& out) {
  const HandheldKeyframe& keyframe = session.keyframes[index];
  const bool jpeg = IsJpeg(keyframe.picture);
  const auto image = ReadPicture(keyframe.picture);
  if (!image) return Forward(image);
  if (image->size() != cv::Size(session.camera.width(), session.camera.height()))
    return InputError(Format("%s: %d x %d pixels, allowed is the lens's size, %d x %d",
                             keyframe.picture.c_str(), image->cols, image->rows,
                             session.camera.width(), session.camera.height()));
  rig::FrameRecord frame;
  frame.image =
      "frames/" + Format("%03zu", index) + (jpeg ? ".png" : keyframe.picture.extension().string());
  const auto bytes = jpeg ? rig::EncodeImage(frame.image, *image) : ReadFile(keyframe.picture);
  if (!bytes) return Forward(bytes);
  frame.X_WC = keyframe.X_WC;
  frame.X_WT = session.X_WT;
  frame.sha256 = Sha256Hex(*bytes);
  if (const Status written = WriteFileAtomic(out / frame.image, *bytes); !written)
    return Forward(written);
  return frame;
}

Result<rig::Target> CopyTarget(const HandheldSession& session, const fs::path& out) {
  if (const auto* sphere = std::get_if<calib::SphereShape>(&session.target)) return *sphere;
  if (const auto* plane = std::get_if<calib::PlaneShape>(&session.target)) return *plane;
  const fs::path& mesh = std::get<fs::path>(session.target);
  const auto bytes = ReadFile(mesh);
  if (!bytes) return Forward(bytes);
  if (const auto shape = rig::ParseMesh(*bytes, mesh); !shape) return Forward(shape);
  const std::string name = "target" + mesh.extension().string();
  if (const Status written = WriteFileAtomic(out / name, *bytes); !written) return Forward(written);
  return rig::MeshFile{name};
}

}  // namespace

Status WriteHandheldSession(const HandheldSession& session, const fs::path& out) {
  if (const Status status = CheckNewFolder(out); !status) return status;
  if (const Status status = MakeDirectory(out / "frames"); !status) return status;
  auto target = CopyTarget(session, out);
  if (!target) return Forward(target);
  rig::Session written;
  written.name = session.name;
  written.length_unit = "mm";
  written.camera_path = "camera.cameramodel";
  written.camera = session.camera;
  written.radiometry = session.radiometry;
  written.target = std::move(*target);
  for (std::size_t i = 0; i < session.keyframes.size(); ++i) {
    auto frame = CopyPicture(session, i, out);
    if (!frame) return Forward(frame);
    written.frames.push_back(std::move(*frame));
  }
  return rig::WriteSession(written, out);
}

}  // namespace turnlight::app
