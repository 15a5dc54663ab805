// A session on disk, version 1 (design, section 7): a folder with session.json, the camera model,
// frames/, masks, a mesh. Raw data never changes. Everything lies under the folder's root.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/file.h"
#include "base/result.h"
#include "calib/camera_model.h"
#include "calib/pose.h"
#include "calib/radiometry.h"
#include "calib/target_shape.h"
#include "rig/session/picture_notes.h"

namespace turnlight::rig {

inline constexpr char kSessionFile[] = "session.json";

struct MeshFile {
  std::string path;  // relative; PLY or OBJ, in T and the session's length unit
};
using Target = std::variant<calib::SphereShape, calib::PlaneShape, MeshFile>;

struct FrameRecord {
  std::string image;                    // relative path
  std::optional<std::string> mask;      // non-zero = target
  std::optional<std::string> validity;  // non-zero = pixel may be used
  std::optional<double> angle_deg;
  std::optional<double> angle_measured_deg;
  calib::Exposure exposure;
  bool has_gain = false;  // gain_db was given in the file
  calib::Pose X_WC;
  calib::Pose X_WT;
  std::optional<std::string> sha256;  // of the image file's bytes
};

// A copy of the rig's calibration that the session was captured with.
struct CalibrationFile {
  std::string path;  // relative
  std::string sha256;
};

// Why a capture ended where it did, if that was not the end of its plan.
struct CaptureEnd {
  std::string code;   // stable, such as "early"
  std::string words;  // for people
};

struct Session {
  std::string name;
  std::string length_unit;  // "mm", "m", ...: any word without spaces
  std::string camera_path;  // relative
  std::optional<CalibrationFile> calibration;
  calib::Radiometry radiometry;  // references filled in from frame 0
  std::optional<std::string> bayer;
  Target target;
  std::vector<FrameRecord> frames;
  std::optional<CaptureEnd> ended;  // written for people and tools; reading passes over it

  std::filesystem::path root;                // where it was read from
  std::optional<calib::CameraModel> camera;  // always set by ReadSession
};

// Reads and validates session.json and the camera model. Images and meshes are not opened, but
// every path must stay under the root (no absolute path, no "..", no symbolic link out) and exist.
Result<Session> ReadSession(const std::filesystem::path& root);

// Writes root/session.json and the camera model. Images, masks and meshes are the caller's.
// Writes atomically; every double reads back to the same bits.
Status WriteSession(const Session& session, const std::filesystem::path& root,
                    FileOps& ops = SystemFileOps());

// One frame, decoded. image: R, G, B or grey, CV_8U, CV_16U or CV_32F, of the camera's size. mask:
// 255 = target and valid, else 0 (whole picture if the frame has neither mask nor validity). Bayer
// mosaics are demosaiced. facts: what the picture's file says of itself, and its levels before
// demosaicing. Fails (kInput): checksum mismatch, damaged file, wrong size, channels, an all-zero
// mask.
struct FrameImages {
  cv::Mat image;
  cv::Mat1b mask;
  PictureFacts facts;
};
Result<FrameImages> ReadFrameImages(const Session& session, std::size_t frame);

// "frame 3 (30.0 deg)", or "closure frame (360.0 deg)", as messages about a frame begin.
std::string FrameLabel(std::size_t index, std::optional<double> angle_deg, bool closure = false);

// The target's shape; reads the mesh if there is one. What had to be mended in it is appended to
// remarks, if that is given.
Result<calib::TargetShape> ReadTarget(const Session& session,
                                      std::vector<std::string>* remarks = nullptr);

// What `turnlight verify` says: everything that is wrong with the session, one line each; empty
// when all is well. Reads every file, and goes on after a bad frame. A folder without session.json
// but with a journal is a capture that was not finished.
struct VerifyReport {
  std::vector<std::string> problems;
  std::vector<std::string> remarks;  // not wrong, worth knowing: frames without a checksum, ...
  std::size_t frames = 0;            // read without a problem
  // Commanded angles of frames that are damaged, or that an unfinished capture has not got.
  std::vector<double> lost_angles_deg;
  bool session_good = false;  // what is wrong, if anything, is wrong with files of frames
  // The SHA-256 of what `sha256sum` prints for session.json and all files it names, sorted by path:
  // a line "<sha256>  <path>\n" each, paths as session.json has them. "" with problems. Files that
  // session.json does not name (truth.json, provenance.jsonl) do not count.
  std::string content_sha256;
};
// Fails only if there is neither a session.json nor a journal to verify.
Result<VerifyReport> VerifySession(const std::filesystem::path& root);

}  // namespace turnlight::rig
