// A raw capture on disk, version 1 (docs/design.md, "A raw capture on disk"): a folder with
// capture.json and pictures, taken with a rig of which nothing need be known yet. Calibrations are
// made of it. Everything lies under the folder's root.
#pragma once

#include <cstddef>
#include <filesystem>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/file.h"
#include "base/result.h"
#include "calib/radiometry.h"
#include "rig/rig_calibration.h"

namespace turnlight::rig {

inline constexpr char kCaptureFile[] = "capture.json";

struct RawCaptureFrame {
  std::string image;                // relative path
  std::optional<std::string> kind;  // what it shows: "board", "empty", "dark", ...: any word
  std::optional<double> angle_deg;  // where the table was sent
  std::optional<double> angle_measured_deg;  // where it said that it was
  calib::Exposure exposure;
  bool has_gain = false;              // gain_db was given in the file
  std::optional<std::string> sha256;  // of the image file's bytes
};

struct RawCapture {
  std::string name;
  calib::Radiometry radiometry;      // nominal: linear, black 0, white what a full pixel reads
  std::optional<std::string> bayer;  // pictures are mosaics
  CalibratedDevices devices;
  std::vector<RawCaptureFrame> frames;

  std::filesystem::path root;  // where it was read from
};

// Whether the path is a folder with a capture.json, or that file.
bool IsRawCapture(const std::filesystem::path& path);

// Reads and validates capture.json, given by its folder or itself. Pictures are not opened, but
// every path must stay under the root (no absolute path, no "..", no symbolic link out) and exist,
// and no picture may be named twice. Fails (kInput) with file, key, value and what is allowed.
// A capture that is being gone on with may have lost pictures.
enum class RawPictures { kMustBeThere, kMayBeMissing };
Result<RawCapture> ReadRawCapture(const std::filesystem::path& path,
                                  RawPictures pictures = RawPictures::kMustBeThere);

// Writes root/capture.json, atomically; every double reads back to the same bits. Pictures are the
// caller's. Fails (kInput) for what would be refused when read, but for files that are missing.
Status WriteRawCapture(const RawCapture& capture, const std::filesystem::path& root,
                       FileOps& ops = SystemFileOps());

// One picture, decoded: DN, R, G, B or grey, of the capture's resolution. A mosaic is demosaiced,
// or stays as the sensor gave it. Fails (kInput): a file that changed or is damaged, another size.
enum class Mosaic { kDemosaiced, kAsRecorded };
Result<cv::Mat> ReadRawImage(const RawCapture& capture, std::size_t frame,
                             Mosaic mosaic = Mosaic::kDemosaiced);

// By index, in the file's order: the frames of a kind.
std::vector<std::size_t> FramesOfKind(const RawCapture& capture, const std::string& kind);

}  // namespace turnlight::rig
