// The YAML side of rig/sim/synthetic_config.h.
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/angles.h"
#include "base/file.h"
#include "base/strict_object.h"
#include "estimator/results/scene_json.h"
#include "estimator/results/words.h"
#include "rig/sim/synthetic_config.h"

namespace turnlight::rig::sim {
namespace {

using estimator::results::ReadOptionalWord;
using estimator::results::WordOf;
using nlohmann::ordered_json;

constexpr std::uint64_t kMaxConfigBytes = 16 << 20;

using rig::sim::ReadField;  // beside those below, which would hide it

void ReadField(StrictObject& object, const char* key, Interval& value) {
  if (const auto pair = object.OptionalNumbers(key, 2)) value = {(*pair)[0], (*pair)[1]};
}

void ReadField(StrictObject& object, const char* key, Eigen::Vector3d& value) {
  if (const auto list = object.OptionalNumbers(key, 3))
    value = {(*list)[0], (*list)[1], (*list)[2]};
}

std::optional<double> NumberOrNull(StrictObject& object, const char* key) {
  return object.Raw(key).is_null() ? std::nullopt : object.OptionalNumber(key);
}

Status ReadTarget(StrictObject object, SyntheticTarget& target) {
  const std::string shape = object.Choice("shape", {"sphere", "plane", "blob"});
  if (shape == "sphere") {
    calib::SphereShape sphere{50.0};
    ReadField(object, "radius", sphere.radius);
    target = sphere;
  } else if (shape == "plane") {
    calib::PlaneShape plane{200.0, 150.0, 1};
    if (const auto size = object.OptionalNumbers("size", 2)) {
      plane.width = (*size)[0];
      plane.height = (*size)[1];
    }
    ReadField(object, "sides", plane.sides);
    target = plane;
  } else {
    Blob blob;
    ReadField(object, "radius", blob.radius);
    ReadField(object, "depth", blob.depth);
    ReadField(object, "segments", blob.segments);
    target = blob;
  }
  return object.Finish();
}

Status ReadMotion(StrictObject object, Motion& motion) {
  if (object.OptionalChoice("kind", {"orbit", "table"}) == "table")
    motion.kind = MotionKind::kTable;
  ReadField(object, "frames", motion.frames);
  ReadField(object, "step_deg", motion.step_deg);
  ReadField(object, "distance", motion.distance);
  ReadField(object, "elevation_deg", motion.elevation_deg);
  ReadField(object, "tilt_deg", motion.tilt_deg);
  return object.Finish();
}

Status ReadCamera(StrictObject object, SyntheticCamera& camera) {
  if (const auto size = object.OptionalNumbers("size", 2, {.min = 1.0, .max = 1e6})) {
    if (std::floor((*size)[0]) != (*size)[0] || std::floor((*size)[1]) != (*size)[1])
      object.Refuse("size", "a list of 2 whole numbers");
    camera.width = static_cast<int>((*size)[0]);
    camera.height = static_cast<int>((*size)[1]);
  }
  ReadField(object, "focal_px", camera.focal_px);
  ReadField(object, "vignetting", camera.vignetting);
  const auto distortion = object.OptionalNumbers("distortion", 8);
  if (object.OptionalChoice("lens", {"pinhole", "opencv8"}) == "opencv8") {
    camera.distortion.emplace();
    if (distortion) std::copy(distortion->begin(), distortion->end(), camera.distortion->begin());
  } else if (distortion) {
    object.RefuseText("distortion", "only the lens opencv8 has a distortion");
  }
  return object.Finish();
}

Status ReadLightList(StrictObject& object, SyntheticConfig& config) {
  std::vector<LightSpec> lights;
  for (StrictObject& entry : object.Objects("lights", 1)) {
    LightSpec light;
    const std::vector<double> direction = entry.Numbers("direction", 3);
    light.direction = {direction[0], direction[1], direction[2]};
    light.distance = NumberOrNull(entry, "distance");
    ReadField(entry, "intensity", light.intensity);
    ReadField(entry, "color", light.color);
    if (auto factors = entry.OptionalList("factors", {.min = 0.0}))
      light.factors = std::move(*factors);
    if (Status status = entry.Finish(); !status) return status;
    lights.push_back(light);
  }
  config.lights = std::move(lights);
  return {};
}

Status ReadRandomLights(StrictObject object, SyntheticConfig& config) {
  RandomLights random;
  ReadField(object, "count", random.count);
  ReadField(object, "min_separation_deg", random.min_separation_deg);
  ReadField(object, "zenith_max_deg", random.zenith_max_deg);
  ReadField(object, "distance", random.distance);
  ReadField(object, "distant_share", random.distant_share);
  ReadField(object, "intensity", random.intensity);
  config.lights = random;
  return object.Finish();
}

Status ReadRandomReflectance(StrictObject object, SyntheticConfig& config) {
  RandomReflectance random;
  random.model =
      ReadOptionalWord<estimator::model::SpecularModel>(object, "model").value_or(random.model);
  random.diffuse_model = ReadOptionalWord<estimator::model::DiffuseModel>(object, "diffuse_model")
                             .value_or(random.diffuse_model);
  ReadField(object, "albedo", random.albedo);
  ReadField(object, "ambient", random.ambient);
  ReadField(object, "diffuse", random.diffuse);
  ReadField(object, "specular", random.specular);
  ReadField(object, "shininess", random.shininess);
  ReadField(object, "roughness_deg", random.roughness_deg);
  config.reflectance = random;
  return object.Finish();
}

Status ReadEncoding(StrictObject& object, Sensor& sensor) {
  if (!object.Raw("encoding").is_object()) {
    if (object.OptionalChoice("encoding", {"linear", "srgb", "{gamma: NUMBER}"}) == "srgb")
      sensor.encoding = calib::Encoding::kSrgb;
    return {};
  }
  auto gamma = object.Object("encoding");
  sensor.encoding = calib::Encoding::kGamma;
  sensor.gamma = gamma.Number("gamma");
  return gamma.Finish();
}

Status ReadSensor(StrictObject object, Sensor& sensor) {
  const nlohmann::json& bits = object.Raw("bits");
  if (bits == 8)
    sensor.depth = SensorDepth::k8;
  else if (bits == "float")
    sensor.depth = SensorDepth::kFloat;
  else if (!bits.is_null() && bits != 16)
    object.Refuse("bits", "one of 8, 16, float");
  const auto format = object.OptionalChoice("format", {"png", "tiff", "exr"});
  if (format == "png") sensor.format = FileFormat::kPng;
  if (format == "tiff") sensor.format = FileFormat::kTiff;
  if (format == "exr") sensor.format = FileFormat::kExr;
  if (Status status = ReadEncoding(object, sensor); !status) return status;
  ReadField(object, "black", sensor.black);
  sensor.white = NumberOrNull(object, "white");
  sensor.saturation = NumberOrNull(object, "saturation");
  ReadField(object, "noise_relative", sensor.noise_relative);
  ReadField(object, "noise_shot", sensor.noise_shot);
  sensor.clip_share = NumberOrNull(object, "clip_share");
  return object.Finish();
}

// Two keys that say the same thing in different ways.
void RefuseBoth(StrictObject& object, const char* key, const char* other) {
  if (object.Has(key) && object.Has(other))
    object.RefuseText(other,
                      std::string("it stands beside ") + key + ", allowed is one of the two");
}

Status ReadParts(StrictObject& object, SyntheticConfig& config) {
  if (auto part = object.OptionalObject("target"))
    if (Status status = ReadTarget(*part, config.target); !status) return status;
  if (auto part = object.OptionalObject("motion"))
    if (Status status = ReadMotion(*part, config.motion); !status) return status;
  if (auto part = object.OptionalObject("camera"))
    if (Status status = ReadCamera(*part, config.camera); !status) return status;
  if (object.Has("lights"))
    if (Status status = ReadLightList(object, config); !status) return status;
  if (auto part = object.OptionalObject("random_lights"))
    if (Status status = ReadRandomLights(*part, config); !status) return status;
  if (auto part = object.OptionalObject("reflectance")) {
    config.reflectance = estimator::results::ReadReflectance(*part);
    if (Status status = part->Finish(); !status) return status;
  }
  if (auto part = object.OptionalObject("random_reflectance"))
    if (Status status = ReadRandomReflectance(*part, config); !status) return status;
  if (auto part = object.OptionalObject("sensor"))
    if (Status status = ReadSensor(*part, config.sensor); !status) return status;
  object.Ignore("lights");
  return {};
}

ordered_json ToJson(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
ordered_json ToJson(Interval interval) { return {interval.low, interval.high}; }
ordered_json ToJson(const std::optional<double>& value) {
  return value ? ordered_json(*value) : ordered_json(nullptr);
}

ordered_json ToJson(const SyntheticTarget& target) {
  if (const auto* sphere = std::get_if<calib::SphereShape>(&target))
    return {{"shape", "sphere"}, {"radius", sphere->radius}};
  if (const auto* plane = std::get_if<calib::PlaneShape>(&target))
    return {{"shape", "plane"},
            {"size", ordered_json::array({plane->width, plane->height})},
            {"sides", plane->sides}};
  const auto& blob = std::get<Blob>(target);
  return {{"shape", "blob"},
          {"radius", blob.radius},
          {"depth", blob.depth},
          {"segments", blob.segments}};
}

ordered_json ToJson(const Motion& motion) {
  return {{"kind", motion.kind == MotionKind::kOrbit ? "orbit" : "table"},
          {"frames", motion.frames},
          {"step_deg", motion.step_deg},
          {"distance", motion.distance},
          {"elevation_deg", motion.elevation_deg},
          {"tilt_deg", motion.tilt_deg}};
}

ordered_json ToJson(const SyntheticCamera& camera) {
  ordered_json json{{"size", ordered_json::array({camera.width, camera.height})},
                    {"focal_px", camera.focal_px},
                    {"lens", camera.distortion ? "opencv8" : "pinhole"}};
  if (camera.distortion) json["distortion"] = *camera.distortion;
  json["vignetting"] = camera.vignetting;
  return json;
}

void AddLights(ordered_json& json, const SyntheticConfig& config) {
  if (const auto* list = std::get_if<std::vector<LightSpec>>(&config.lights)) {
    json["lights"] = ordered_json::array();
    for (const LightSpec& light : *list) {
      auto& out = json["lights"].emplace_back(ordered_json{{"direction", ToJson(light.direction)},
                                                           {"distance", ToJson(light.distance)},
                                                           {"intensity", light.intensity},
                                                           {"color", ToJson(light.color)}});
      if (!light.factors.empty()) out["factors"] = light.factors;
    }
    return;
  }
  const auto& random = std::get<RandomLights>(config.lights);
  json["random_lights"] = ordered_json{{"count", random.count},
                                       {"min_separation_deg", random.min_separation_deg},
                                       {"zenith_max_deg", random.zenith_max_deg},
                                       {"distance", ToJson(random.distance)},
                                       {"distant_share", random.distant_share},
                                       {"intensity", ToJson(random.intensity)}};
}

void AddReflectance(ordered_json& json, const SyntheticConfig& config) {
  if (const auto* given = std::get_if<estimator::model::Reflectance>(&config.reflectance)) {
    json["reflectance"] = ordered_json{{"model", WordOf(given->lobes[0].model)},
                                       {"diffuse_model", WordOf(given->diffuse_model)},
                                       {"albedo", ToJson(given->albedo)},
                                       {"ambient", given->ambient},
                                       {"diffuse", given->diffuse},
                                       {"specular", given->lobes[0].strength},
                                       {"shininess", given->lobes[0].shape},
                                       {"roughness_deg", RadToDeg(given->roughness)}};
    if (estimator::results::NeedsLobeList(*given)) {
      json["reflectance"]["lobes"] = estimator::results::LobeList(*given);
      json["reflectance"]["shininess"] = nullptr;
    }
    const Eigen::Vector3d white = Eigen::Vector3d::Ones();
    if (given->ambient_colour != white)
      json["reflectance"]["ambient_color"] = ToJson(given->ambient_colour);
    if (given->specular_colour != white)
      json["reflectance"]["specular_color"] = ToJson(given->specular_colour);
    if (!given->harmonics.isZero(0.0))
      json["reflectance"]["ambient_harmonics"] =
          std::vector<double>(given->harmonics.begin(), given->harmonics.end());
    return;
  }
  const auto& random = std::get<RandomReflectance>(config.reflectance);
  json["random_reflectance"] = ordered_json{
      {"model", WordOf(random.model)},         {"diffuse_model", WordOf(random.diffuse_model)},
      {"albedo", ToJson(random.albedo)},       {"ambient", ToJson(random.ambient)},
      {"diffuse", ToJson(random.diffuse)},     {"specular", ToJson(random.specular)},
      {"shininess", ToJson(random.shininess)}, {"roughness_deg", ToJson(random.roughness_deg)}};
}

ordered_json ToJson(const Sensor& sensor) {
  const calib::Radiometry radiometry = sensor.ToRadiometry();
  ordered_json json;
  json["bits"] = sensor.depth == SensorDepth::k8    ? ordered_json(8)
                 : sensor.depth == SensorDepth::k16 ? ordered_json(16)
                                                    : ordered_json("float");
  json["format"] = sensor.Format() == FileFormat::kPng    ? "png"
                   : sensor.Format() == FileFormat::kTiff ? "tiff"
                                                          : "exr";
  json["encoding"] = sensor.encoding == calib::Encoding::kLinear ? ordered_json("linear")
                     : sensor.encoding == calib::Encoding::kSrgb
                         ? ordered_json("srgb")
                         : ordered_json{{"gamma", sensor.gamma}};
  json["black"] = sensor.black;
  json["white"] = radiometry.white;
  json["saturation"] = radiometry.SaturationDn();
  json["noise_relative"] = sensor.noise_relative;
  json["noise_shot"] = sensor.noise_shot;
  json["clip_share"] = ToJson(sensor.clip_share);
  return json;
}

// Objects as indented keys, everything else in YAML's flow style, which is JSON.
void AppendYaml(const ordered_json& object, const std::string& indent, std::string& out) {
  for (const auto& [key, value] : object.items()) {
    out += indent + key + ":";
    if (value.is_object()) {
      out += "\n";
      AppendYaml(value, indent + "  ", out);
    } else if (value.is_array() && !value.empty() && value[0].is_object()) {
      out += "\n";
      for (const auto& entry : value) out += indent + "  - " + entry.dump() + "\n";
    } else {
      out += " " + value.dump() + "\n";
    }
  }
}

}  // namespace

Result<SyntheticConfig> ParseSyntheticConfig(const std::string& text, const std::string& file) {
  auto document = ParseYaml(text, file);
  if (!document) return Forward(document);
  return ReadSyntheticConfig(StrictObject(*document));
}

Result<SyntheticConfig> ReadSyntheticConfig(StrictObject object) {
  SyntheticConfig config;
  config.seed = static_cast<std::uint64_t>(
      object.OptionalInteger("seed", 0, std::int64_t{1} << 53).value_or(1));
  config.name = object.OptionalString("name").value_or(config.name);
  RefuseBoth(object, "lights", "random_lights");
  RefuseBoth(object, "reflectance", "random_reflectance");
  ReadField(object, "samples_per_side", config.samples_per_side);
  config.masks = object.OptionalBoolean("masks").value_or(config.masks);
  if (!object.ok()) return Forward(object.Finish());
  if (Status status = ReadParts(object, config); !status) return Forward(status);
  if (Status status = object.Finish(); !status) return Forward(status);
  if (const auto problem = Validate(config))
    return InputError(object.Where(problem->key) + ": " + problem->text);
  return config;
}

Result<SyntheticConfig> ReadSyntheticConfig(const std::filesystem::path& path) {
  auto text = ReadTypedFile(path, kMaxConfigBytes);
  if (!text) return Forward(text);
  return ParseSyntheticConfig(*text, path.string());
}

std::string ToYaml(const SyntheticConfig& config) {
  ordered_json json;
  json["seed"] = config.seed;
  json["name"] = config.name;
  json["target"] = ToJson(config.target);
  json["motion"] = ToJson(config.motion);
  json["camera"] = ToJson(config.camera);
  AddLights(json, config);
  AddReflectance(json, config);
  json["sensor"] = ToJson(config.sensor);
  json["samples_per_side"] = config.samples_per_side;
  json["masks"] = config.masks;
  std::string yaml;
  AppendYaml(json, "", yaml);
  return yaml;
}

}  // namespace turnlight::rig::sim
