#include "rig/session/session_fields.h"

#include <algorithm>
#include <vector>

namespace turnlight::rig {
namespace {

using nlohmann::ordered_json;

constexpr Range kPositive{.above = 0.0};

Status ReadEncoding(StrictObject& object, calib::Radiometry& radiometry) {
  const nlohmann::json& value = object.Raw("encoding");
  if (value == "linear") {
    radiometry.encoding = calib::Encoding::kLinear;
  } else if (value == "srgb") {
    radiometry.encoding = calib::Encoding::kSrgb;
  } else if (value.is_object()) {
    StrictObject gamma = object.Object("encoding");
    gamma.AllowPrefix("x-");
    radiometry.encoding = calib::Encoding::kGamma;
    radiometry.gamma = gamma.Number("gamma", {.min = 0.1, .max = 10.0});
    return gamma.Finish();
  } else {
    object.Refuse("encoding", "\"linear\", \"srgb\" or {\"gamma\": a number}");
  }
  return {};
}

ordered_json PrintEncoding(const calib::Radiometry& radiometry) {
  switch (radiometry.encoding) {
    case calib::Encoding::kLinear:
      return "linear";
    case calib::Encoding::kSrgb:
      return "srgb";
    case calib::Encoding::kGamma:
      return {{"gamma", radiometry.gamma}};
  }
  return nullptr;
}

}  // namespace

Status ReadRadiometry(StrictObject& object, calib::Radiometry& radiometry) {
  Status encoding = ReadEncoding(object, radiometry);
  radiometry.black = object.Number("black");
  radiometry.white = object.Number("white");
  if (object.ok() && radiometry.white <= radiometry.black)
    object.Refuse("white", "a finite number above black");
  radiometry.saturation = object.OptionalNumber("saturation");
  if (object.ok() && radiometry.saturation && *radiometry.saturation <= radiometry.black)
    object.Refuse("saturation", "a finite number above black");
  radiometry.reference_exposure_us = object.OptionalNumber("reference_exposure_us", kPositive);
  radiometry.reference_gain_db = object.OptionalNumber("reference_gain_db");
  if (const auto balance = object.OptionalNumbers("white_balance", 3, kPositive))
    radiometry.white_balance = {(*balance)[0], (*balance)[1], (*balance)[2]};
  return encoding;
}

ordered_json PrintRadiometryCore(const calib::Radiometry& radiometry) {
  ordered_json object{{"encoding", PrintEncoding(radiometry)},
                      {"black", radiometry.black},
                      {"white", radiometry.white}};
  if (radiometry.saturation) object["saturation"] = *radiometry.saturation;
  return object;
}

calib::Pose ReadPose(StrictObject& object, const std::string& key) {
  const auto rows = object.Matrix(key, 3, 4);
  if (!object.ok()) return {};
  const auto pose = calib::PoseFromRows(rows, object.Where(key));
  if (pose) return *pose;
  // PoseFromRows begins with the place already, and so does RefuseText.
  const std::string where = object.Where(key) + ": ";
  const std::string& text = pose.error().text;
  object.RefuseText(key, text.starts_with(where) ? text.substr(where.size()) : text);
  return {};
}

ordered_json PrintPose(const calib::Pose& pose) {
  const std::vector<double> rows = calib::RowsFromPose(pose);
  ordered_json matrix = ordered_json::array();
  for (auto row = rows.begin(); row != rows.end(); row += 4)
    matrix.push_back(std::vector<double>(row, row + 4));
  return matrix;
}

Target ReadTargetKeys(StrictObject& object) {
  const std::string shape = object.Choice("shape", {"sphere", "plane", "mesh"});
  if (shape == "sphere") return calib::SphereShape{object.Number("radius", kPositive)};
  if (shape == "mesh") return MeshFile{object.String("path")};
  const auto size = object.Numbers("size", 2, kPositive);
  const auto sides = object.OptionalInteger("sides", 1, 2).value_or(1);
  return calib::PlaneShape{size[0], size[1], static_cast<int>(sides)};
}

bool IsSha256(const std::string& text) {
  return text.size() == 64 && text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

bool IsWord(const std::string& text) {
  return !text.empty() && std::all_of(text.begin(), text.end(),
                                      [](unsigned char c) { return c > ' ' && c != 0x7f; });
}

}  // namespace turnlight::rig
