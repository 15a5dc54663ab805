#include "rig/session/session_files.h"

#include <algorithm>
#include <system_error>

#include "base/file.h"
#include "base/sha256.h"
#include "rig/session/image_file.h"
#include "rig/session/journal.h"

namespace turnlight::rig {

namespace fs = std::filesystem;

namespace {
constexpr std::uint64_t kMaxSessionBytes = std::uint64_t{1} << 28;

// Where the session is if the folder has none: a run keeps it one folder below.
std::string WhereInstead(const fs::path& root) {
  const auto has = [](const fs::path& folder, const char* file) {
    std::error_code code;
    return fs::exists(folder / file, code);
  };
  if (has(root, kSessionFile)) return "";
  if (has(root, kJournalFile))
    return "; the capture was not finished, turnlight resume of the run's folder completes it";
  const fs::path below = root / "session";
  if (has(below, kSessionFile) || has(below, kJournalFile))
    return "; this is the folder of a run, its session is " + below.string();
  return ", allowed is the folder of a session" + NearestPath(root);
}
}  // namespace

std::vector<NamedPath> PathsOfFrame(const FrameRecord& frame, std::size_t index) {
  const std::string key = "frames/" + std::to_string(index) + "/";
  std::vector<NamedPath> paths{{key + "image", frame.image}};
  if (frame.mask) paths.push_back({key + "mask", *frame.mask});
  if (frame.validity) paths.push_back({key + "validity", *frame.validity});
  return paths;
}

std::vector<NamedPath> PathsOf(const Session& session) {
  std::vector<NamedPath> paths{{"camera", session.camera_path}};
  if (session.calibration) paths.push_back({"calibration/path", session.calibration->path});
  if (const auto* mesh = std::get_if<MeshFile>(&session.target))
    paths.push_back({"target/path", mesh->path});
  for (std::size_t i = 0; i < session.frames.size(); ++i)
    for (NamedPath& named : PathsOfFrame(session.frames[i], i)) paths.push_back(std::move(named));
  return paths;
}

Status CheckRelative(const NamedPath& named, const fs::path& root) {
  const std::string file = (root / named.file).string();
  const std::string begin = file + ": " + named.key + ": \"" + named.path + "\" ";
  const fs::path path(named.path);
  if (path.empty()) return InputError(begin + "is empty, allowed is a path in its folder");
  if (std::any_of(named.path.begin(), named.path.end(),
                  [](unsigned char c) { return c < ' ' || c == 0x7f; }))
    return InputError(file + ": " + named.key + ": holds a control character, allowed is a path");
  if (path.is_absolute())
    return InputError(begin + "is absolute, allowed are paths relative to its folder");
  if (std::find(path.begin(), path.end(), "..") != path.end())
    return InputError(begin + "contains \"..\", allowed are paths within its folder");
  return {};
}

Result<fs::path> Locate(const fs::path& root, const NamedPath& named) {
  if (const Status status = CheckRelative(named, root); !status) return Forward(status);
  const std::string begin =
      (root / named.file).string() + ": " + named.key + ": \"" + named.path + "\" ";
  std::error_code code;
  const fs::path real_root = fs::canonical(root, code);
  if (code) return InputError(root.string() + ": cannot open the folder: " + code.message());
  const fs::path real = fs::canonical(root / named.path, code);
  if (code)
    return InputError(begin + "cannot be opened: " + code.message() +
                      "; every file that it names must be there");
  const auto [end, rest] =
      std::mismatch(real_root.begin(), real_root.end(), real.begin(), real.end());
  if (end != real_root.end()) return InputError(begin + "is a link that leads out of its folder");
  if (!fs::is_regular_file(real, code)) return InputError(begin + "is not a regular file");
  return root / named.path;
}

Result<Picture> ReadNamedPicture(const fs::path& file, const std::string& key,
                                 const std::optional<std::string>& sha256, cv::Size size) {
  const auto bytes = ReadFile(file);
  if (!bytes) return Forward(bytes);
  const std::string is = sha256 ? Sha256Hex(*bytes) : std::string();
  if (sha256 && is != *sha256)
    return InputError(file.string() + ": the file changed: its SHA-256 is " + is + ", " + key +
                      " is " + *sha256 +
                      "; copy it again from where it was made, or remove that key if the change "
                      "was meant");
  return DecodePicture(*bytes, file, size);
}

Result<ParsedSession> LoadSession(const fs::path& root) {
  const fs::path file = root / kSessionFile;
  const auto text = ReadFile(file, kMaxSessionBytes);
  if (!text) return InputError(text.error().text + WhereInstead(root));
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

}  // namespace turnlight::rig
