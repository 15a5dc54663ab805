#include "rig/session/session_fields.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace turnlight::rig {
namespace {

using nlohmann::ordered_json;

constexpr Range kPositive{.above = 0.0};

constexpr std::size_t kMostCurvePoints = 4096;

// [[share of white as stored, linear share], ...], both strictly rising from [0, 0] to [1, 1].
bool ReadCurve(const nlohmann::json& value, std::vector<std::array<double, 2>>& curve) {
  if (!value.is_array() || value.size() < 2 || value.size() > kMostCurvePoints) return false;
  for (const nlohmann::json& point : value) {
    if (!point.is_array() || point.size() != 2 || !point[0].is_number() || !point[1].is_number())
      return false;
    const std::array<double, 2> next{point[0].get<double>(), point[1].get<double>()};
    if (!std::isfinite(next[0]) || !std::isfinite(next[1])) return false;
    if (!curve.empty() && !(next[0] > curve.back()[0] && next[1] > curve.back()[1])) return false;
    curve.push_back(next);
  }
  return curve.front() == std::array{0.0, 0.0} && curve.back() == std::array{1.0, 1.0};
}

Status ReadEncodingObject(StrictObject encoding, calib::Radiometry& radiometry) {
  encoding.AllowPrefix("x-");
  if (encoding.Has("curve") && !encoding.Has("gamma")) {
    radiometry.encoding = calib::Encoding::kCurve;
    if (!ReadCurve(encoding.Raw("curve"), radiometry.curve))
      encoding.RefuseText("curve",
                          "allowed are 2 to " + std::to_string(kMostCurvePoints) +
                              " points [stored share, linear share], both strictly rising from "
                              "[0, 0] to [1, 1]");
  } else {
    radiometry.encoding = calib::Encoding::kGamma;
    radiometry.gamma = encoding.Number("gamma", {.min = 0.1, .max = 10.0});
  }
  return encoding.Finish();
}

Status ReadEncoding(StrictObject& object, calib::Radiometry& radiometry) {
  const nlohmann::json& value = object.Raw("encoding");
  if (value == "linear") {
    radiometry.encoding = calib::Encoding::kLinear;
  } else if (value == "srgb") {
    radiometry.encoding = calib::Encoding::kSrgb;
  } else if (value.is_object()) {
    return ReadEncodingObject(object.Object("encoding"), radiometry);
  } else {
    object.Refuse("encoding",
                  "\"linear\", \"srgb\", {\"gamma\": a number} or {\"curve\": [points]}");
  }
  return {};
}

constexpr int kShareSamples = 1000;

Status ReadVignetting(StrictObject object, std::optional<calib::Vignetting>& out) {
  object.AllowPrefix("x-");
  calib::Vignetting vignetting;
  const auto center = object.Numbers("center", 2);
  vignetting.center_x = center[0];
  vignetting.center_y = center[1];
  vignetting.radius = object.Number("radius", kPositive);
  const nlohmann::json& list = object.Raw("coefficients");
  const std::size_t count = list.is_array() ? std::clamp<std::size_t>(list.size(), 1, 4) : 1;
  vignetting.coefficients = object.Numbers("coefficients", count);
  for (int i = 0; object.ok() && i <= kShareSamples; ++i) {
    const double share = vignetting.Share(static_cast<double>(i) / kShareSamples);
    if (share < calib::kLeastShare || share > calib::kMostShare)
      object.Refuse("coefficients",
                    "1 to 4 numbers with a share of light of 0.05 to 2 everywhere "
                    "within the radius");
  }
  out = std::move(vignetting);
  return object.Finish();
}

Status ReadNoiseModel(StrictObject object, std::optional<calib::NoiseModel>& out) {
  object.AllowPrefix("x-");
  calib::NoiseModel noise;
  noise.read_noise_dn = object.Number("read_noise_dn", {.min = 0.0});
  noise.dn_per_electron = object.Number("dn_per_electron", {.min = 0.0});
  noise.gain_db = object.OptionalNumber("gain_db");
  if (object.ok() && noise.read_noise_dn == 0.0 && noise.dn_per_electron == 0.0)
    object.Refuse("read_noise_dn", "a number above 0, or dn_per_electron is above 0");
  out = noise;
  return object.Finish();
}

ordered_json PrintEncoding(const calib::Radiometry& radiometry) {
  switch (radiometry.encoding) {
    case calib::Encoding::kLinear:
      return "linear";
    case calib::Encoding::kSrgb:
      return "srgb";
    case calib::Encoding::kGamma:
      return {{"gamma", radiometry.gamma}};
    case calib::Encoding::kCurve:
      return {{"curve", radiometry.curve}};
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
  if (const auto vignetting = object.OptionalObject("vignetting"))
    if (const Status status = ReadVignetting(*vignetting, radiometry.vignetting);
        encoding && !status)
      return status;
  return encoding;
}

Status ReadNoise(StrictObject& object, calib::Radiometry& radiometry) {
  const auto noise = object.OptionalObject("noise");
  return noise ? ReadNoiseModel(*noise, radiometry.noise) : Status();
}

ordered_json PrintVignetting(const calib::Vignetting& vignetting) {
  return {{"center", {vignetting.center_x, vignetting.center_y}},
          {"radius", vignetting.radius},
          {"coefficients", vignetting.coefficients}};
}

ordered_json PrintNoise(const calib::NoiseModel& noise) {
  ordered_json object{{"read_noise_dn", noise.read_noise_dn},
                      {"dn_per_electron", noise.dn_per_electron}};
  if (noise.gain_db) object["gain_db"] = *noise.gain_db;
  return object;
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
