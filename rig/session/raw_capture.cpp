#include "rig/session/raw_capture.h"

#include <exception>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "rig/session/mosaic.h"
#include "rig/session/session_fields.h"
#include "rig/session/session_files.h"

namespace turnlight::rig {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr char kFormat[] = "turnlight-capture";
constexpr std::uint64_t kMaxCaptureBytes = std::uint64_t{1} << 28;

Status ReadNominal(StrictObject object, RawCapture& capture) {
  object.AllowPrefix("x-");
  if (Status status = ReadRadiometry(object, capture.radiometry); !status) return status;
  capture.bayer = object.OptionalChoice("bayer", BayerPatterns());
  return object.Finish();
}

Result<RawCaptureFrame> ReadRawFrame(StrictObject object) {
  RawCaptureFrame frame;
  object.AllowPrefix("x-");
  frame.image = object.String("image");
  frame.kind = object.OptionalString("kind");
  if (frame.kind && !IsWord(*frame.kind)) object.Refuse("kind", "a word without spaces");
  frame.angle_deg = object.OptionalNumber("angle_deg");
  frame.angle_measured_deg = object.OptionalNumber("angle_measured_deg");
  frame.exposure.exposure_us = object.OptionalNumber("exposure_us", {.above = 0.0});
  const auto gain_db = object.OptionalNumber("gain_db");
  frame.has_gain = gain_db.has_value();
  frame.exposure.gain_db = gain_db.value_or(0.0);
  frame.sha256 = object.OptionalString("sha256");
  if (frame.sha256 && !IsSha256(*frame.sha256))
    object.Refuse("sha256", "64 lower-case hexadecimal digits");
  if (const Status status = object.Finish(); !status) return Forward(status);
  return frame;
}

Status ReadRawFrames(const std::vector<StrictObject>& objects, RawCapture& capture) {
  std::map<std::string, std::size_t> seen;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    auto frame = ReadRawFrame(objects[i]);
    if (!frame) return Forward(frame);
    const auto [first, is_new] =
        seen.emplace(fs::path(frame->image).lexically_normal().string(), i);
    if (!is_new)
      return InputError(objects[i].Where("image") + ": \"" + frame->image + "\", that is frames/" +
                        std::to_string(first->second) + " already; allowed is a picture each");
    capture.frames.push_back(std::move(*frame));
  }
  return {};
}

Result<RawCapture> ParseRawCapture(const std::string& text, const std::string& file) {
  const auto document = ParseJson(text, file);
  if (!document) return Forward(document);
  StrictObject object(*document);
  object.AllowPrefix("x-");
  object.Choice("format", {kFormat});
  if (object.Integer("version", INT64_MIN, INT64_MAX) != 1 && object.ok())
    object.Refuse("version", "1, the version that this program reads");
  if (!object.ok()) return Forward(object.Finish());
  RawCapture capture;
  capture.name = object.String("name");
  const StrictObject radiometry = object.Object("radiometry"), identity = object.Object("identity");
  const auto frames = object.Objects("frames", 1);
  Status status = object.Finish();
  if (status) status = ReadNominal(radiometry, capture);
  if (status) status = ReadDevices(identity, capture.devices);
  if (status) status = ReadRawFrames(frames, capture);
  if (!status) return Forward(status);
  return capture;
}

NamedPath PathOf(const RawCapture& capture, std::size_t frame) {
  return {"frames/" + std::to_string(frame) + "/image", capture.frames[frame].image, kCaptureFile};
}

ordered_json PrintNominal(const RawCapture& capture) {
  const calib::Radiometry& radiometry = capture.radiometry;
  ordered_json object = PrintRadiometryCore(radiometry);
  if (radiometry.reference_exposure_us)
    object["reference_exposure_us"] = *radiometry.reference_exposure_us;
  if (radiometry.reference_gain_db) object["reference_gain_db"] = *radiometry.reference_gain_db;
  if (radiometry.white_balance != std::array<double, 3>{1.0, 1.0, 1.0})
    object["white_balance"] = radiometry.white_balance;
  if (capture.bayer) object["bayer"] = *capture.bayer;
  return object;
}

ordered_json PrintRawFrame(const RawCaptureFrame& frame) {
  ordered_json object{{"image", frame.image}};
  if (frame.kind) object["kind"] = *frame.kind;
  if (frame.angle_deg) object["angle_deg"] = *frame.angle_deg;
  if (frame.angle_measured_deg) object["angle_measured_deg"] = *frame.angle_measured_deg;
  if (frame.exposure.exposure_us) object["exposure_us"] = *frame.exposure.exposure_us;
  if (frame.has_gain) object["gain_db"] = frame.exposure.gain_db;
  if (frame.sha256) object["sha256"] = *frame.sha256;
  return object;
}

std::string PrintRawCapture(const RawCapture& capture) {
  const std::pair<const char*, ordered_json> parts[] = {
      {"format", kFormat},
      {"version", 1},
      {"name", capture.name},
      {"radiometry", PrintNominal(capture)},
      {"identity", PrintDevices(capture.devices)}};
  std::string text = "{\n";
  for (const auto& [key, value] : parts)
    text += " \"" + std::string(key) + "\": " + value.dump() + ",\n";
  text += " \"frames\": [";
  for (std::size_t i = 0; i < capture.frames.size(); ++i)
    text += (i == 0 ? "\n  " : ",\n  ") + PrintRawFrame(capture.frames[i]).dump();
  return text + "\n ]\n}\n";
}

fs::path RootOf(const fs::path& path) {
  if (path.filename() != kCaptureFile) return path;
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

}  // namespace

bool IsRawCapture(const fs::path& path) {
  std::error_code code;
  return fs::is_regular_file(RootOf(path) / kCaptureFile, code);
}

Result<RawCapture> ReadRawCapture(const fs::path& path, RawPictures pictures) {
  const fs::path root = RootOf(path), file = root / kCaptureFile;
  const auto text = ReadFile(file, kMaxCaptureBytes);
  if (!text) return Forward(text);
  auto capture = ParseRawCapture(*text, file.string());
  if (!capture) return Forward(capture);
  for (std::size_t i = 0; i < capture->frames.size(); ++i)
    if (pictures == RawPictures::kMustBeThere) {
      if (const auto located = Locate(root, PathOf(*capture, i)); !located) return Forward(located);
    } else if (const Status status = CheckRelative(PathOf(*capture, i), root); !status) {
      return Forward(status);
    }
  capture->root = root;
  return capture;
}

Status WriteRawCapture(const RawCapture& capture, const fs::path& root, FileOps& ops) {
  const fs::path file = root / kCaptureFile;
  for (std::size_t i = 0; i < capture.frames.size(); ++i)
    if (const Status status = CheckRelative(PathOf(capture, i), root); !status) return status;
  std::string text;
  try {
    text = PrintRawCapture(capture);
  } catch (const std::exception& error) {  // a name that is not UTF-8
    return InputError(file.string() + ": " + error.what());
  }
  if (const auto parsed = ParseRawCapture(text, file.string()); !parsed) return Forward(parsed);
  return WriteFileAtomic(file, text, ops);
}

Result<cv::Mat> ReadRawImage(const RawCapture& capture, std::size_t frame, Mosaic mosaic) {
  const fs::path file = capture.root / kCaptureFile;
  if (frame >= capture.frames.size())
    return InputError(file.string() + ": frame " + std::to_string(frame) +
                      " was asked for, it has " + std::to_string(capture.frames.size()) +
                      ", counted from 0");
  const auto located = Locate(capture.root, PathOf(capture, frame));
  if (!located) return Forward(located);
  try {
    auto picture = ReadNamedPicture(*located, "frames/" + std::to_string(frame) + "/sha256",
                                    capture.frames[frame].sha256, capture.devices.resolution);
    if (!picture) return Forward(picture);
    if (capture.bayer && mosaic != Mosaic::kAsRecorded) {
      const Status status = Demosaic(*capture.bayer, located->string(), picture->image);
      if (!status) return Forward(status);
    }
    return std::move(picture->image);
  } catch (const std::exception& error) {  // of OpenCV: no memory
    return SystemError(located->string() + ": " + error.what());
  }
}

std::vector<std::size_t> FramesOfKind(const RawCapture& capture, const std::string& kind) {
  std::vector<std::size_t> frames;
  for (std::size_t i = 0; i < capture.frames.size(); ++i)
    if (capture.frames[i].kind == kind) frames.push_back(i);
  return frames;
}

}  // namespace turnlight::rig
