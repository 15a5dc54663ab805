#include "rig/session/session.h"

#include <algorithm>
#include <exception>
#include <opencv2/imgproc.hpp>
#include <set>
#include <system_error>

#include "base/file.h"
#include "base/parallel.h"
#include "base/sha256.h"
#include "rig/session/image_file.h"
#include "rig/session/mesh_file.h"
#include "rig/session/session_json.h"

namespace turnlight::rig {
namespace {

namespace fs = std::filesystem;

constexpr char kSessionFile[] = "session.json";
constexpr std::uint64_t kMaxSessionBytes = std::uint64_t{1} << 28;

// A path of the session, and where it is named.
struct NamedPath {
  std::string key;  // "frames/3/image"
  std::string path;
};

std::vector<NamedPath> PathsOfFrame(const Session& session, std::size_t index) {
  const FrameRecord& frame = session.frames[index];
  const std::string key = "frames/" + std::to_string(index) + "/";
  std::vector<NamedPath> paths{{key + "image", frame.image}};
  if (frame.mask) paths.push_back({key + "mask", *frame.mask});
  if (frame.validity) paths.push_back({key + "validity", *frame.validity});
  return paths;
}

std::vector<NamedPath> PathsOf(const Session& session) {
  std::vector<NamedPath> paths{{"camera", session.camera_path}};
  if (const auto* mesh = std::get_if<MeshFile>(&session.target))
    paths.push_back({"target/path", mesh->path});
  for (std::size_t i = 0; i < session.frames.size(); ++i)
    for (NamedPath& named : PathsOfFrame(session, i)) paths.push_back(std::move(named));
  return paths;
}

// Refuses what cannot be a path below a folder, whatever the file system holds.
Status CheckRelative(const NamedPath& named, const std::string& file) {
  const std::string begin = file + ": " + named.key + ": \"" + named.path + "\" ";
  const fs::path path(named.path);
  if (path.empty())
    return InputError(begin + "is empty, allowed is a path in the session's folder");
  if (std::any_of(named.path.begin(), named.path.end(),
                  [](unsigned char c) { return c < ' ' || c == 0x7f; }))
    return InputError(file + ": " + named.key + ": holds a control character, allowed is a path");
  if (path.is_absolute())
    return InputError(begin + "is absolute, allowed are paths relative to the session's folder");
  if (std::find(path.begin(), path.end(), "..") != path.end())
    return InputError(begin + "contains \"..\", allowed are paths within the session's folder");
  return {};
}

// The file that a path of the session names. Fails if it is missing or lies outside the root.
Result<fs::path> Locate(const fs::path& root, const NamedPath& named) {
  const std::string file = (root / kSessionFile).string();
  if (const Status status = CheckRelative(named, file); !status) return Forward(status);
  const std::string begin = file + ": " + named.key + ": \"" + named.path + "\" ";
  std::error_code code;
  const fs::path real_root = fs::canonical(root, code);
  if (code) return InputError(root.string() + ": cannot open the folder: " + code.message());
  const fs::path real = fs::canonical(root / named.path, code);
  if (code)
    return InputError(begin + "cannot be opened: " + code.message() +
                      "; every file that a session names must be there");
  const auto [end, rest] =
      std::mismatch(real_root.begin(), real_root.end(), real.begin(), real.end());
  if (end != real_root.end())
    return InputError(begin + "is a link that leads out of the session's folder");
  if (!fs::is_regular_file(real, code)) return InputError(begin + "is not a regular file");
  return root / named.path;
}

// session.json, with everything that is wrong with its text, and the camera model. Fails if there
// is no session.json.
Result<ParsedSession> Load(const fs::path& root) {
  const fs::path file = root / kSessionFile;
  const auto text = ReadFile(file, kMaxSessionBytes);
  if (!text) return Forward(text);
  ParsedSession parsed = ParseSession(*text, file.string());
  Session& session = parsed.session;
  session.root = root;
  if (session.camera_path.empty() && !parsed.problems.empty()) return parsed;  // refused already
  const auto path = Locate(root, {"camera", session.camera_path});
  auto camera =
      path ? calib::CameraModel::FromFile(*path) : Result<calib::CameraModel>(Forward(path));
  if (camera)
    session.camera = std::move(*camera);
  else
    parsed.problems.push_back(camera.error().text);
  return parsed;
}

int DemosaicCode(const std::string& pattern) {
  if (pattern == "RGGB") return cv::COLOR_BayerRGGB2RGB_EA;
  if (pattern == "BGGR") return cv::COLOR_BayerBGGR2RGB_EA;
  if (pattern == "GRBG") return cv::COLOR_BayerGRBG2RGB_EA;
  return cv::COLOR_BayerGBRG2RGB_EA;
}

Status Demosaic(const std::string& pattern, const std::string& file, cv::Mat& image) {
  if (image.channels() != 1 || image.depth() == CV_32F || image.rows < 4 || image.cols < 4)
    return InputError(file + ": the session's radiometry/bayer is " + pattern +
                      ", which needs pictures of 1 channel, 8 or 16 bits and 4 x 4 pixels or more");
  cv::Mat colour;
  cv::demosaicing(image, colour, DemosaicCode(pattern));
  image = colour;
  return {};
}

Result<cv::Mat1b> ReadMask(const fs::path& file, cv::Size size) {
  const auto picture = ReadImage(file, size);
  if (!picture) return Forward(picture);
  std::vector<cv::Mat> channels;
  cv::split(*picture, channels);
  cv::Mat1b mask(size, 0);
  for (const cv::Mat& channel : channels) mask |= channel != 0;
  return mask;
}

Result<FrameImages> ReadFrame(const Session& session, std::size_t index) {
  const FrameRecord& frame = session.frames[index];
  const std::string key = "frames/" + std::to_string(index) + "/";
  const cv::Size size(session.camera->width(), session.camera->height());

  const auto file = Locate(session.root, {key + "image", frame.image});
  if (!file) return Forward(file);
  const auto bytes = ReadFile(*file);
  if (!bytes) return Forward(bytes);
  const std::string sha256 = frame.sha256 ? Sha256Hex(*bytes) : std::string();
  if (frame.sha256 && sha256 != *frame.sha256)
    return InputError(file->string() + ": the file changed: its SHA-256 is " + sha256 + ", " + key +
                      "sha256 is " + *frame.sha256);
  auto image = DecodeImage(*bytes, *file, size);
  if (!image) return Forward(image);
  FrameImages images{std::move(*image), cv::Mat1b(size, 255)};
  if (session.bayer) {
    const Status status = Demosaic(*session.bayer, file->string(), images.image);
    if (!status) return Forward(status);
  }
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
  return images;
}

// Everything that is wrong with the files of one frame.
std::vector<std::string> FrameProblems(const Session& session, std::size_t index) {
  std::vector<std::string> problems;
  for (const NamedPath& named : PathsOfFrame(session, index))
    if (const auto path = Locate(session.root, named); !path) problems.push_back(path.error().text);
  if (!problems.empty()) return problems;
  const auto images = ReadFrameImages(session, index);
  if (!images) problems.push_back(images.error().text);
  return problems;
}

// What `sha256sum` prints for all files of the session, sorted by path.
Result<std::string> ContentLines(const Session& session) {
  std::set<std::string> paths{kSessionFile};
  for (const NamedPath& named : PathsOf(session)) paths.insert(named.path);
  std::string lines;
  for (const std::string& path : paths) {
    const auto bytes = ReadFile(session.root / path);
    if (!bytes) return Forward(bytes);
    lines += Sha256Hex(*bytes) + "  " + path + "\n";
  }
  return lines;
}

}  // namespace

Result<Session> ReadSession(const fs::path& root) {
  auto parsed = Load(root);
  if (!parsed) return Forward(parsed);
  if (!parsed->problems.empty()) return InputError(parsed->problems.front());
  for (const NamedPath& named : PathsOf(parsed->session))
    if (const auto path = Locate(root, named); !path) return Forward(path);
  return std::move(parsed->session);
}

Status WriteSession(const Session& session, const fs::path& root) {
  const std::string file = (root / kSessionFile).string();
  if (!session.camera) return InputError(file + ": camera: missing, a session needs one");
  if (session.frames.empty())
    return InputError(file + ": frames: an empty list, allowed is at least 1 frame");
  for (const NamedPath& named : PathsOf(session))
    if (const Status status = CheckRelative(named, file); !status) return status;
  const std::string text = PrintSession(session);
  // What would be refused when read is not written.
  const ParsedSession parsed = ParseSession(text, file);
  if (!parsed.problems.empty()) return InputError(parsed.problems.front());
  const fs::path camera_file = root / session.camera_path;
  const fs::path folder = camera_file.parent_path();
  Status status = folder.empty() ? Status() : MakeDirectory(folder);
  if (status) status = WriteFileAtomic(camera_file, session.camera->ToString());
  if (status) status = WriteFileAtomic(file, text);
  return status;
}

Result<FrameImages> ReadFrameImages(const Session& session, std::size_t frame) {
  if (frame >= session.frames.size() || !session.camera)
    return InputError(session.root.string() + ": frame " + std::to_string(frame) + " of " +
                      std::to_string(session.frames.size()) + " was asked for");
  try {
    return ReadFrame(session, frame);
  } catch (const std::exception& error) {  // of OpenCV: no memory
    return SystemError(session.root.string() + ": " + FrameLabel(session, frame) + ": " +
                       error.what());
  }
}

Result<calib::TargetShape> ReadTarget(const Session& session) {
  if (const auto* sphere = std::get_if<calib::SphereShape>(&session.target)) return *sphere;
  if (const auto* plane = std::get_if<calib::PlaneShape>(&session.target)) return *plane;
  const std::string& path = std::get<MeshFile>(session.target).path;
  const auto file = Locate(session.root, {"target/path", path});
  if (!file) return Forward(file);
  auto mesh = ReadMesh(*file);
  if (!mesh) return Forward(mesh);
  return std::move(*mesh);
}

Result<VerifyReport> VerifySession(const fs::path& root) {
  auto parsed = Load(root);
  if (!parsed) return Forward(parsed);
  const Session& session = parsed->session;
  VerifyReport report;
  report.problems = std::move(parsed->problems);
  if (!session.camera) return report;  // its size is what every frame is checked against
  const auto target = ReadTarget(session);
  if (!target) report.problems.push_back(target.error().text);
  report.session_good = report.problems.empty();

  std::vector<std::vector<std::string>> problems(session.frames.size());
  ParallelFor(problems.size(), [&](std::size_t i) { problems[i] = FrameProblems(session, i); });
  for (std::size_t i = 0; i < problems.size(); ++i) {
    if (problems[i].empty()) ++report.frames;
    for (const std::string& problem : problems[i])
      report.problems.push_back(FrameLabel(session, i) + ": " + problem);
  }
  const auto without_checksum =
      std::count_if(session.frames.begin(), session.frames.end(),
                    [](const FrameRecord& frame) { return !frame.sha256; });
  if (without_checksum > 0)
    report.remarks.push_back(std::to_string(without_checksum) + " of " +
                             std::to_string(session.frames.size()) +
                             " frames have no sha256: a change of their pictures goes unseen");
  if (!report.problems.empty()) return report;
  const auto lines = ContentLines(session);
  if (!lines) return Forward(lines);
  report.content_sha256 = Sha256Hex(*lines);
  return report;
}

}  // namespace turnlight::rig
