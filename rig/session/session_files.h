// Which files a session or a raw capture names, and where they are. Internal to this folder.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "rig/session/image_file.h"
#include "rig/session/session.h"
#include "rig/session/session_json.h"

namespace turnlight::rig {

// A path, and where it is named.
struct NamedPath {
  std::string key;  // "frames/3/image"
  std::string path;
  std::string file = kSessionFile;  // that names it
};

// All of them; and those of one frame.
std::vector<NamedPath> PathsOf(const Session& session);
std::vector<NamedPath> PathsOfFrame(const FrameRecord& frame, std::size_t index);

// Refuses what cannot be a path below a folder, whatever the file system holds.
Status CheckRelative(const NamedPath& named, const std::filesystem::path& root);

// The file that a path names. Fails if it is missing or lies outside the root.
Result<std::filesystem::path> Locate(const std::filesystem::path& root, const NamedPath& named);

// A located picture, decoded as image_file.h says; size is checked if it is not empty. Fails
// (kInput) too if its bytes are not those of sha256, which key names.
Result<Picture> ReadNamedPicture(const std::filesystem::path& file, const std::string& key,
                                 const std::optional<std::string>& sha256, cv::Size size);

// session.json, with everything that is wrong with its text, and the camera model. Fails if there
// is no session.json.
Result<ParsedSession> LoadSession(const std::filesystem::path& root);

}  // namespace turnlight::rig
