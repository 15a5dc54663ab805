#include "rig/session/session.h"

#include <exception>

#include "base/file.h"
#include "base/sha256.h"
#include "rig/session/image_file.h"
#include "rig/session/mesh_file.h"
#include "rig/session/mosaic.h"
#include "rig/session/session_files.h"

namespace turnlight::rig {
namespace {

namespace fs = std::filesystem;

Result<FrameImages> ReadFrame(const Session& session, std::size_t index) {
  const FrameRecord& frame = session.frames[index];
  const std::string key = "frames/" + std::to_string(index) + "/";
  const cv::Size size(session.camera->width(), session.camera->height());

  const auto file = Locate(session.root, {key + "image", frame.image});
  if (!file) return Forward(file);
  auto picture = ReadNamedPicture(*file, key + "sha256", frame.sha256, size);
  if (!picture) return Forward(picture);
  FrameImages images{std::move(picture->image), cv::Mat1b(size, 255), {}};
  images.facts.file = frame.image;
  images.facts.claims = std::move(picture->claims);
  for (const auto& [name, path] : {std::pair("mask", frame.mask), {"validity", frame.validity}}) {
    if (!path) continue;
    const auto mask_file = Locate(session.root, {key + name, *path});
    if (!mask_file) return Forward(mask_file);
    const auto mask = ReadMask(*mask_file, size);
    if (!mask) return Forward(mask);
    images.mask &= *mask;
    if (cv::countNonZero(images.mask) == 0)
      return InputError(mask_file->string() + ": the " + name +
                        " leaves no pixel, allowed is at least one non-zero pixel");
  }
  images.facts.levels = MeasureLevels(images.image, images.mask);
  if (session.bayer) {
    const Status status = Demosaic(*session.bayer, file->string(), images.image);
    if (!status) return Forward(status);
  }
  return images;
}

}  // namespace

Result<Session> ReadSession(const fs::path& root) {
  auto parsed = LoadSession(root);
  if (!parsed) return Forward(parsed);
  if (!parsed->problems.empty()) return InputError(parsed->problems.front());
  for (const NamedPath& named : PathsOf(parsed->session))
    if (const auto path = Locate(root, named); !path) return Forward(path);
  return std::move(parsed->session);
}

Status WriteSession(const Session& session, const fs::path& root, FileOps& ops) {
  const std::string file = (root / kSessionFile).string();
  if (!session.camera) return InputError(file + ": camera: missing, a session needs one");
  if (session.frames.empty())
    return InputError(file + ": frames: an empty list, allowed is at least 1 frame");
  for (const NamedPath& named : PathsOf(session))
    if (const Status status = CheckRelative(named, root); !status) return status;
  const std::string text = PrintSession(session);
  // What would be refused when read is not written.
  const ParsedSession parsed = ParseSession(text, file);
  if (!parsed.problems.empty()) return InputError(parsed.problems.front());
  const fs::path camera_file = root / session.camera_path;
  const fs::path folder = camera_file.parent_path();
  Status status = folder.empty() ? Status() : MakeDirectory(folder, ops);
  if (status) status = WriteFileAtomic(camera_file, session.camera->ToString(), ops);
  if (status) status = WriteFileAtomic(file, text, ops);
  return status;
}

Result<FrameImages> ReadFrameImages(const Session& session, std::size_t frame) {
  if (frame >= session.frames.size() || !session.camera)
    return InputError(session.root.string() + ": frame " + std::to_string(frame) +
                      " was asked for, it has " + std::to_string(session.frames.size()) +
                      ", counted from 0");
  try {
    return ReadFrame(session, frame);
  } catch (const std::exception& error) {  // of OpenCV: no memory
    return SystemError(session.root.string() + ": " +
                       FrameLabel(frame, session.frames[frame].angle_deg) + ": " + error.what());
  }
}

Result<calib::TargetShape> ReadTarget(const Session& session, std::vector<std::string>* remarks) {
  if (const auto* sphere = std::get_if<calib::SphereShape>(&session.target)) return *sphere;
  if (const auto* plane = std::get_if<calib::PlaneShape>(&session.target)) return *plane;
  const std::string& path = std::get<MeshFile>(session.target).path;
  const auto file = Locate(session.root, {"target/path", path});
  if (!file) return Forward(file);
  auto mesh = ReadMesh(*file, remarks);
  if (!mesh) return Forward(mesh);
  return std::move(*mesh);
}

}  // namespace turnlight::rig
