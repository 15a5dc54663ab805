#include "estimator/results/scene_json.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "base/angles.h"
#include "base/format.h"
#include "estimator/results/words.h"

namespace turnlight::estimator::results {
namespace {

using model::DiffuseModel;
using model::InitialGuess;
using model::Light;
using model::Lobe;
namespace reflectance = model::reflectance;
using model::Reflectance;
using model::Scene;
using model::SpecularModel;

constexpr int kDigits = 4;  // of numbers in messages
constexpr double kMaxDisagreementDeg = 0.1;
constexpr double kMaxDistanceDisagreement = 1e-3;

enum class Purpose { kRender, kGuess };

constexpr char kNotDetermined[] =
    "null: that estimate did not determine it; write a number in its place, or estimate from more "
    "pictures";

Eigen::Vector3d ToVector(const std::vector<double>& numbers) {
  return {numbers[0], numbers[1], numbers[2]};
}

// A vector that is unit to the last bits stays as it is, so that files round-trip.
Eigen::Vector3d Unit(const Eigen::Vector3d& v) {
  const double squared = v.squaredNorm();
  if (std::abs(squared - 1.0) <= 8.0 * std::numeric_limits<double>::epsilon()) return v;
  return v.stableNormalized();
}

std::optional<Eigen::Vector3d> OptionalVector(StrictObject& object, const char* key) {
  if (object.Raw(key).is_null()) return std::nullopt;
  const auto numbers = object.OptionalNumbers(key, 3);
  return numbers ? std::optional(ToVector(*numbers)) : std::nullopt;
}

std::optional<double> OptionalNumberOrNull(StrictObject& object, const char* key, Range range) {
  return object.Raw(key).is_null() ? std::nullopt : object.OptionalNumber(key, range);
}

// Position and direction, and position and inverse distance, must say the same of a scene.
void CheckPosition(StrictObject& object, const Light& light, const Eigen::Vector3d& position,
                   bool has_inverse_distance) {
  const double angle_deg =
      RadToDeg(std::atan2(light.direction.cross(position).norm(), light.direction.dot(position)));
  if (!(angle_deg <= kMaxDisagreementDeg))
    object.RefuseText("position", "it lies " + NumberText(angle_deg, kDigits) +
                                      " degrees off the light's direction, allowed is at most " +
                                      NumberText(kMaxDisagreementDeg, kDigits));
  if (!has_inverse_distance) return;
  const double relative = std::abs(light.inverse_distance * position.norm() - 1.0);
  if (!(relative <= kMaxDistanceDisagreement))
    object.RefuseText("inverse_distance", "it disagrees with the length of position by " +
                                              NumberText(100.0 * relative, kDigits) +
                                              " %, allowed is at most 0.1 %");
}

void ReadPlace(StrictObject& object, Purpose purpose, Light& light) {
  const Eigen::Vector3d direction = ToVector(object.Numbers("direction", 3));
  const auto position = OptionalVector(object, "position");
  const auto inverse_distance = OptionalNumberOrNull(object, "inverse_distance", {.min = 0.0});
  if (!object.ok()) return;
  if (!(direction.stableNorm() > 1e-100))
    return object.RefuseText("direction", "it has no length, allowed is any other vector");
  if (position && !(position->stableNorm() > 1e-100))
    return object.RefuseText("position", "it is W's origin, allowed is any other place, or null");
  light.direction = Unit(direction);
  light.inverse_distance = inverse_distance.value_or(position ? 1.0 / position->stableNorm() : 0.0);
  if (purpose == Purpose::kGuess || !position) return;
  CheckPosition(object, light, *position, inverse_distance.has_value());
  if (!inverse_distance) light.direction = Unit(*position);
}

struct LightRead {
  Light light;
  bool has_intensity = false;
};

Result<LightRead> ReadLight(StrictObject object, Purpose purpose, bool from_result) {
  LightRead read;
  if (from_result) {
    object.AllowUnknown();
    // The position repeats direction and inverse distance, rounded; those two are exact.
    read.light.direction = ToVector(object.Numbers("direction", 3));
    read.light.inverse_distance = object.Number("inverse_distance", {.min = 0.0});
    if (object.ok() && !(read.light.direction.stableNorm() > 1e-100))
      object.RefuseText("direction", "it has no length, allowed is any other vector");
    if (object.ok()) read.light.direction = Unit(read.light.direction);
  } else {
    ReadPlace(object, purpose, read.light);
  }
  const auto intensity = OptionalNumberOrNull(object, "intensity", {.min = 0.0});
  if (object.ok() && purpose == Purpose::kRender && !intensity)
    object.RefuseText("intensity", from_result && object.Has("intensity")
                                       ? kNotDetermined
                                       : "this key is missing, and rendering needs it");
  read.light.intensity = intensity.value_or(1.0);
  read.has_intensity = intensity.has_value();
  if (const auto color = object.OptionalNumbers("color", 3, {.min = 0.0}))
    read.light.color = ToVector(*color);
  if (auto factors = object.OptionalList("factors", {.min = 0.0}))
    read.light.factors = std::move(*factors);
  object.AllowPrefix("x-");
  if (Status status = object.Finish(); !status) return Forward(status);
  return read;
}

struct SceneRead {
  std::vector<LightRead> lights;
  std::optional<Reflectance> reflectance;
};

Result<SceneRead> ReadLights(StrictObject& object, Purpose purpose, bool from_result) {
  SceneRead read;
  for (StrictObject& entry : object.Objects("lights", purpose == Purpose::kGuess ? 1 : 0)) {
    auto light = ReadLight(std::move(entry), purpose, from_result);
    if (!light) return Forward(light);
    read.lights.push_back(*light);
  }
  return read;
}

Result<SceneRead> ReadTruth(StrictObject object, Purpose purpose) {
  auto read = ReadLights(object, purpose, false);
  if (!read) return read;
  if (auto reflectance = object.OptionalObject("reflectance")) {
    read->reflectance = ReadReflectance(*reflectance);
    reflectance->AllowPrefix("x-");
    if (Status status = reflectance->Finish(); !status) return Forward(status);
  }
  object.OptionalString("note");
  object.AllowPrefix("x-");
  if (Status status = object.Finish(); !status) return Forward(status);
  return read;
}

double SpecularOf(StrictObject& object, SpecularModel model) {
  if (model == SpecularModel::kNone)
    return OptionalNumberOrNull(object, "specular", {.min = 0.0, .max = 0.0}).value_or(0.0);
  return object.Number("specular", {.min = 0.0});
}

// The keys of one lobe. One without strength has no width: its shape may be absent, or less than
// any lobe's.
Lobe LobeOf(StrictObject& object, SpecularModel model) {
  Lobe lobe{model, SpecularOf(object, model)};
  const reflectance::LobeFacts& facts = model::FactsOf(model);
  const char* key = facts.shape_key;
  if (lobe.strength > 0.0)
    lobe.shape = object.Number(key, {.min = facts.least_shape, .max = facts.most_shape});
  else
    lobe.shape = std::max(
        OptionalNumberOrNull(object, key, {.min = 0.0, .max = facts.most_shape}).value_or(1.0),
        facts.least_shape);
  if (facts.physical)
    lobe.f0 =
        OptionalNumberOrNull(object, "f0", {.min = model::kLeastF0, .max = 1.0}).value_or(1.0);
  return lobe;
}

// All lobes: those of `lobes`, if there is such a list, else the one that the other keys are of.
std::array<Lobe, model::kMostLobes> LobesOf(StrictObject& object, SpecularModel first,
                                            bool from_result) {
  std::array<Lobe, model::kMostLobes> lobes{};
  if (!object.Has("lobes")) {
    lobes[0] = LobeOf(object, first);
    return lobes;
  }
  for (const char* key : {"specular", "shininess"}) object.Ignore(key);
  std::vector<StrictObject> list = object.Objects("lobes", 1);
  if (list.size() > lobes.size()) {
    object.RefuseText("lobes", std::to_string(list.size()) + " lobes, allowed are at most " +
                                   std::to_string(lobes.size()));
    return lobes;
  }
  for (std::size_t k = 0; k < list.size(); ++k) {
    const auto model = ReadWord<SpecularModel>(list[k], "model");
    if (list[k].ok() && model == SpecularModel::kNone)
      list[k].RefuseText("model", "\"none\", allowed is any other model, or no such lobe");
    lobes[k] = LobeOf(list[k], model);
    if (from_result) list[k].AllowUnknown();
    list[k].AllowPrefix("x-");
    if (Status status = list[k].Finish(); !status) object.Adopt(status);
  }
  return lobes;
}

void ReadHarmonics(StrictObject& object, Reflectance& reflectance) {
  for (const auto& [key, to] : {std::pair("ambient_harmonics", &reflectance.harmonics),
                                {"diffuse_harmonics", &reflectance.shading}}) {
    const auto numbers = object.OptionalNumbers(key, model::kHarmonics);
    for (std::size_t j = 0; numbers && j < numbers->size(); ++j)
      (*to)[static_cast<Eigen::Index>(j)] = (*numbers)[j];
  }
}

void ReadColours(StrictObject& object, Reflectance& reflectance) {
  if (const auto colour = object.OptionalNumbers("ambient_color", 3, {.min = 0.0}))
    reflectance.ambient_colour = ToVector(*colour);
  if (const auto colour = object.OptionalNumbers("specular_color", 3, {.min = 0.0}))
    reflectance.specular_colour = ToVector(*colour);
}

double RoughnessOf(StrictObject& object, DiffuseModel model) {
  const Range range{.min = 0.0, .max = 90.0};
  if (model == DiffuseModel::kOrenNayar) return DegToRad(object.Number("roughness_deg", range));
  if (OptionalNumberOrNull(object, "roughness_deg", range).value_or(0.0) > 0.0)
    object.RefuseText("roughness_deg", "only the diffuse model oren-nayar has a roughness");
  return 0.0;
}

bool HasNull(const nlohmann::json& value) {
  return value.is_null() ||
         (value.is_array() && std::any_of(value.begin(), value.end(),
                                          [](const auto& element) { return element.is_null(); }));
}

// A value that the estimate did not determine: the first key that is null. None: "".
std::string NullKeyOf(StrictObject& object, StrictObject& model) {
  std::vector<std::string> keys{"albedo", "ambient", "diffuse"};
  if (model.Raw("specular") != WordOf(SpecularModel::kNone) && !object.Has("lobes"))
    keys.insert(keys.end(), {"specular", "shininess"});
  if (model.Raw("diffuse") == WordOf(DiffuseModel::kOrenNayar)) keys.push_back("roughness_deg");
  for (const std::string& key : keys)
    if (object.Has(key) && HasNull(object.Raw(key))) return key;
  if (!object.Has("lobes") || !object.Raw("lobes").is_array()) return "";
  for (const nlohmann::json& lobe : object.Raw("lobes"))
    for (const char* key : {"specular", "shininess", "alpha"})
      if (lobe.is_object() && lobe.contains(key) && lobe[key].is_null()) return "lobes";
  return "";
}

// Nothing where something is not determined, of a guess: it is done without.
Result<std::optional<Reflectance>> ReadResultReflectance(StrictObject object, StrictObject model,
                                                         Purpose purpose) {
  const std::string null_key = NullKeyOf(object, model);
  if (!null_key.empty() && purpose == Purpose::kGuess) return std::optional<Reflectance>();
  if (!null_key.empty()) object.RefuseText(null_key, kNotDetermined);
  Reflectance reflectance;
  const auto first = ReadWord<SpecularModel>(model, "specular");
  reflectance.diffuse_model = ReadWord<DiffuseModel>(model, "diffuse");
  model.AllowUnknown();
  if (Status status = model.Finish(); !status) return Forward(status);
  reflectance.albedo = ToVector(object.Numbers("albedo", 3, {.min = 0.0}));
  reflectance.ambient = object.Number("ambient", {.min = 0.0});
  reflectance.diffuse = object.Number("diffuse", {.min = 0.0});
  reflectance.lobes = LobesOf(object, first, true);
  reflectance.roughness = RoughnessOf(object, reflectance.diffuse_model);
  ReadHarmonics(object, reflectance);
  ReadColours(object, reflectance);
  object.AllowUnknown();
  if (Status status = object.Finish(); !status) return Forward(status);
  return std::optional(reflectance);
}

Result<SceneRead> ReadResult(StrictObject object, Purpose purpose) {
  object.Ignore("format");
  if (object.Integer("version", 1, 1) != 1 || !object.ok()) return Forward(object.Finish());
  auto read = ReadLights(object, purpose, true);
  if (!read) return read;
  StrictObject reflectance_object = object.Object("reflectance");
  StrictObject model_object = object.Object("model");
  object.AllowUnknown();
  if (Status status = object.Finish(); !status) return Forward(status);
  auto reflectance = ReadResultReflectance(reflectance_object, model_object, purpose);
  if (!reflectance) return Forward(reflectance);
  read->reflectance = *reflectance;
  return read;
}

Result<SceneRead> Read(const std::string& text, const std::string& file, Purpose purpose) {
  auto document = ParseJson(text, file);
  if (!document) return Forward(document);
  StrictObject object(*document);
  if (!object.Has("format")) return ReadTruth(std::move(object), purpose);
  if (object.Raw("format") != "turnlight-result") {
    object.Refuse("format", "\"turnlight-result\", or no format at all in a truth.json");
    return Forward(object.Finish());
  }
  return ReadResult(std::move(object), purpose);
}

}  // namespace

Reflectance ReadReflectance(StrictObject& object) {
  Reflectance reflectance;
  // A truth may say "lambert" for a surface without a lobe.
  std::vector<std::string> models = AllWords<SpecularModel>();
  models.push_back(WordOf(DiffuseModel::kLambert));
  const auto first =
      ValueOf<SpecularModel>(object.Choice("model", models)).value_or(SpecularModel::kNone);
  reflectance.albedo = ToVector(object.Numbers("albedo", 3, {.min = 0.0}));
  reflectance.ambient = object.Number("ambient", {.min = 0.0});
  reflectance.diffuse = object.Number("diffuse", {.min = 0.0});
  reflectance.lobes = LobesOf(object, first, false);
  reflectance.diffuse_model =
      ReadOptionalWord<DiffuseModel>(object, "diffuse_model").value_or(DiffuseModel::kLambert);
  reflectance.roughness = RoughnessOf(object, reflectance.diffuse_model);
  ReadHarmonics(object, reflectance);
  ReadColours(object, reflectance);
  return reflectance;
}

Result<Scene> ParseScene(const std::string& text, const std::string& file) {
  auto read = Read(text, file, Purpose::kRender);
  if (!read) return Forward(read);
  if (!read->reflectance)
    return InputError(file +
                      ": reflectance: this key is missing, and rendering needs it; a file with "
                      "lights only serves as estimate --initial");
  Scene scene;
  for (const LightRead& light : read->lights) scene.lights.push_back(light.light);
  scene.reflectance = *read->reflectance;
  return scene;
}

Result<InitialGuess> ParseInitialGuess(const std::string& text, const std::string& file) {
  auto read = Read(text, file, Purpose::kGuess);
  if (!read) return Forward(read);
  InitialGuess guess;
  guess.has_intensities = true;
  for (const LightRead& light : read->lights) {
    guess.lights.push_back(light.light);
    guess.has_intensities &= light.has_intensity;
  }
  guess.reflectance = read->reflectance;
  return guess;
}

}  // namespace turnlight::estimator::results
