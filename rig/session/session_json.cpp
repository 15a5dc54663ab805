#include "rig/session/session_json.h"

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>

#include "rig/session/mosaic.h"
#include "rig/session/session_fields.h"

namespace turnlight::rig {
namespace {

using nlohmann::ordered_json;

void Collect(const Status& status, std::vector<std::string>& problems) {
  if (!status) problems.push_back(status.error().text);
}

// JSON has no NaN, but some writers print it; the parser's message would not say which key it was.
std::string NotANumberHint(const std::string& text) {
  for (const std::string word : {"NaN", "Infinity"}) {
    std::size_t at = text.find(word);
    while (at != std::string::npos && (at == 0 || !std::strchr(" \t\r\n:[,-", text[at - 1])))
      at = text.find(word, at + 1);
    const std::size_t end = at == std::string::npos ? at : text.rfind("\":", at);
    const std::size_t start = end == std::string::npos || end == 0 ? end : text.rfind('"', end - 1);
    if (start == std::string::npos || end == std::string::npos || start >= end) continue;
    return ": " + text.substr(start + 1, end - start - 1) + " holds " + word +
           ", allowed are finite numbers";
  }
  return {};
}

void ParseRadiometry(StrictObject object, Session& session, std::vector<std::string>& problems) {
  object.AllowPrefix("x-");
  Collect(ReadRadiometry(object, session.radiometry), problems);
  Collect(ReadNoise(object, session.radiometry), problems);
  session.bayer = object.OptionalChoice("bayer", BayerPatterns());
  Collect(object.Finish(), problems);
}

void ParseCalibration(StrictObject object, Session& session, std::vector<std::string>& problems) {
  object.AllowPrefix("x-");
  session.calibration = {object.String("path"), object.String("sha256")};
  if (object.ok() && !IsSha256(session.calibration->sha256))
    object.Refuse("sha256", "64 lower-case hexadecimal digits");
  Collect(object.Finish(), problems);
}

void ParseTarget(StrictObject object, Target& target, std::vector<std::string>& problems) {
  object.AllowPrefix("x-");
  target = ReadTargetKeys(object);
  Collect(object.Finish(), problems);
}

// Either all frames carry an exposure or none; frame 0 is the reference unless the file names one.
void SettleExposures(const std::string& file, Session& session,
                     std::vector<std::string>& problems) {
  const FrameRecord& first = session.frames.front();
  for (std::size_t i = 1; i < session.frames.size(); ++i) {
    const bool has = session.frames[i].exposure.exposure_us.has_value();
    if (has == first.exposure.exposure_us.has_value()) continue;
    problems.push_back(file + ": frames/" + std::to_string(has ? 0 : i) +
                       "/exposure_us: missing, while frames/" + std::to_string(has ? i : 0) +
                       " has one; allowed is an exposure on all frames or on none");
    break;
  }
  calib::Radiometry& radiometry = session.radiometry;
  if (!radiometry.reference_exposure_us)
    radiometry.reference_exposure_us = first.exposure.exposure_us;
  if (!radiometry.reference_gain_db) radiometry.reference_gain_db = first.exposure.gain_db;
  for (FrameRecord& frame : session.frames)
    if (!frame.has_gain) frame.exposure.gain_db = *radiometry.reference_gain_db;
}

void ParseFrames(StrictObject& object, const std::string& file, Session& session,
                 std::vector<std::string>& problems) {
  const auto frames = object.Objects("frames", 1);
  for (const StrictObject& frame : frames) session.frames.push_back(ParseFrame(frame, problems));
  if (!session.frames.empty()) SettleExposures(file, session, problems);
}

ordered_json PrintRadiometry(const Session& session) {
  const calib::Radiometry& radiometry = session.radiometry;
  ordered_json object = PrintRadiometryCore(radiometry);
  // The references default to frame 0's: those are not repeated.
  const FrameRecord& first = session.frames.front();
  if (radiometry.reference_exposure_us &&
      radiometry.reference_exposure_us != first.exposure.exposure_us)
    object["reference_exposure_us"] = *radiometry.reference_exposure_us;
  const double default_gain_db = first.has_gain ? first.exposure.gain_db : 0.0;
  if (radiometry.reference_gain_db && *radiometry.reference_gain_db != default_gain_db)
    object["reference_gain_db"] = *radiometry.reference_gain_db;
  if (radiometry.white_balance != std::array<double, 3>{1.0, 1.0, 1.0})
    object["white_balance"] = radiometry.white_balance;
  if (session.bayer) object["bayer"] = *session.bayer;
  if (radiometry.vignetting) object["vignetting"] = PrintVignetting(*radiometry.vignetting);
  if (radiometry.noise) object["noise"] = PrintNoise(*radiometry.noise);
  return object;
}

ordered_json PrintTarget(const Target& target) {
  if (const auto* sphere = std::get_if<calib::SphereShape>(&target))
    return {{"shape", "sphere"}, {"radius", sphere->radius}};
  if (const auto* mesh = std::get_if<MeshFile>(&target))
    return {{"shape", "mesh"}, {"path", mesh->path}};
  const auto& plane = std::get<calib::PlaneShape>(target);
  ordered_json object{{"shape", "plane"}, {"size", std::vector<double>{plane.width, plane.height}}};
  if (plane.sides != 1) object["sides"] = plane.sides;
  return object;
}

}  // namespace

FrameRecord ParseFrame(StrictObject object, std::vector<std::string>& problems) {
  FrameRecord frame;
  object.AllowPrefix("x-");
  frame.image = object.String("image");
  frame.mask = object.OptionalString("mask");
  frame.validity = object.OptionalString("validity");
  frame.angle_deg = object.OptionalNumber("angle_deg");
  frame.angle_measured_deg = object.OptionalNumber("angle_measured_deg");
  frame.exposure.exposure_us = object.OptionalNumber("exposure_us", {.above = 0.0});
  const auto gain_db = object.OptionalNumber("gain_db");
  frame.has_gain = gain_db.has_value();
  frame.exposure.gain_db = gain_db.value_or(0.0);
  frame.X_WC = ReadPose(object, "X_WC");
  frame.X_WT = ReadPose(object, "X_WT");
  frame.sha256 = object.OptionalString("sha256");
  if (frame.sha256 && !IsSha256(*frame.sha256))
    object.Refuse("sha256", "64 lower-case hexadecimal digits");
  Collect(object.Finish(), problems);
  return frame;
}

ordered_json PrintFrame(const FrameRecord& frame) {
  ordered_json object{{"image", frame.image}};
  if (frame.mask) object["mask"] = *frame.mask;
  if (frame.validity) object["validity"] = *frame.validity;
  if (frame.angle_deg) object["angle_deg"] = *frame.angle_deg;
  if (frame.angle_measured_deg) object["angle_measured_deg"] = *frame.angle_measured_deg;
  if (frame.exposure.exposure_us) object["exposure_us"] = *frame.exposure.exposure_us;
  if (frame.has_gain) object["gain_db"] = frame.exposure.gain_db;
  object["X_WC"] = PrintPose(frame.X_WC);
  object["X_WT"] = PrintPose(frame.X_WT);
  if (frame.sha256) object["sha256"] = *frame.sha256;
  return object;
}

ParsedSession ParseSession(const std::string& text, const std::string& file) {
  ParsedSession parsed;
  const auto document = ParseJson(text, file);
  if (!document) {
    parsed.problems.push_back(document.error().text + NotANumberHint(text));
    return parsed;
  }
  Session& session = parsed.session;
  StrictObject object(*document);
  object.AllowPrefix("x-");
  object.Choice("format", {"turnlight-session"});
  if (object.Integer("version", INT64_MIN, INT64_MAX) != 1 && object.ok())
    object.Refuse("version", "1, the version that this program reads");
  if (!object.ok()) {  // another format: what follows would only confuse
    Collect(object.Finish(), parsed.problems);
    return parsed;
  }
  session.name = object.String("name");
  session.length_unit = object.String("length_unit");
  if (object.ok() && !IsWord(session.length_unit))
    object.Refuse("length_unit", "a word without spaces, such as \"mm\"");
  session.camera_path = object.String("camera");
  if (const auto calibration = object.OptionalObject("calibration"))
    ParseCalibration(*calibration, session, parsed.problems);
  ParseRadiometry(object.Object("radiometry"), session, parsed.problems);
  ParseTarget(object.Object("target"), session.target, parsed.problems);
  ParseFrames(object, file, session, parsed.problems);
  const Status status = object.Finish();  // the outermost refusal is told first
  if (!status) parsed.problems.insert(parsed.problems.begin(), status.error().text);
  return parsed;
}

std::string PrintSession(const Session& session) {
  const auto key = [](const std::string& name, const ordered_json& value) {
    return " \"" + name + "\": " + value.dump();
  };
  std::string text = "{\n";
  text += key("format", "turnlight-session") + ",\n" + key("version", 1) + ",\n";
  text += key("name", session.name) + ",\n" + key("length_unit", session.length_unit) + ",\n";
  text += key("camera", session.camera_path) + ",\n";
  if (session.calibration)
    text += key("calibration", ordered_json{{"path", session.calibration->path},
                                            {"sha256", session.calibration->sha256}}) +
            ",\n";
  text += key("radiometry", PrintRadiometry(session)) + ",\n";
  text += key("target", PrintTarget(session.target)) + ",\n \"frames\": [";
  for (std::size_t i = 0; i < session.frames.size(); ++i)
    text += (i == 0 ? "\n  " : ",\n  ") + PrintFrame(session.frames[i]).dump();
  text += "\n ]";
  if (session.ended)
    text += ",\n" + key("x-ended", ordered_json{{"code", session.ended->code},
                                                {"words", session.ended->words}});
  return text + "\n}\n";
}

std::string FrameLabel(std::size_t index, std::optional<double> angle_deg, bool closure) {
  const std::string label = closure ? "closure frame" : "frame " + std::to_string(index);
  return angle_deg ? label + " (" + ordered_json(*angle_deg).dump() + " deg)" : label;
}

}  // namespace turnlight::rig
