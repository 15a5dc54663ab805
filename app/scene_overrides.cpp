#include "app/scene_overrides.h"

#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "base/angles.h"
#include "base/format.h"
#include "base/nearest.h"
#include "estimator/results/words.h"

namespace turnlight::app {
namespace {

using estimator::model::DiffuseModel;
using estimator::model::Light;
using estimator::model::Reflectance;
using estimator::model::Scene;
using estimator::model::SpecularModel;

constexpr std::size_t kPrefix = 6;  // of "light."
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::optional<double> ParseNumber(const std::string& text) {
  if (text == "inf") return kInfinity;
  double value = 0.0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (code != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

std::optional<std::vector<double>> ParseNumbers(const std::string& text, std::size_t count) {
  std::vector<double> numbers;
  std::size_t begin = 0;
  while (begin <= text.size()) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const auto number = ParseNumber(text.substr(begin, end - begin));
    if (!number) return std::nullopt;
    numbers.push_back(*number);
    begin = end + 1;
  }
  if (numbers.size() != count) return std::nullopt;
  return numbers;
}

tl::unexpected<Error> BadValue(const std::string& key, const std::string& value,
                               const std::string& allowed) {
  return InputError("--set " + key + ": " + value + ", allowed is " + allowed);
}

Status SetNumber(const std::string& key, const std::string& value, double min, double max,
                 const std::string& allowed, double& target) {
  const auto number = ParseNumber(value);
  if (!number || !(*number >= min && *number <= max && std::isfinite(*number)))
    return BadValue(key, value, allowed);
  target = *number;
  return {};
}

Status SetModel(const std::string& value, Reflectance& reflectance) {
  const auto model = estimator::results::ValueOf<SpecularModel>(value);
  if (!model)
    return BadValue("model", value,
                    "one of " + Listed(estimator::results::AllWords<SpecularModel>()));
  estimator::model::Lobe& lobe = reflectance.lobes[0];
  // Of another kind of shape: as wide and as bright as it was. Else the shape stays as a number.
  const bool physical = estimator::model::FactsOf(*model).physical;
  if (*model != SpecularModel::kNone && physical == estimator::model::FactsOf(lobe.model).physical)
    lobe.model = *model;
  SetLobeModel(reflectance, *model);
  return {};
}

// shininess or alpha, whichever the lobe's model has.
Status SetShape(const std::string& key, const std::string& value, estimator::model::Lobe& lobe) {
  const auto& facts = estimator::model::FactsOf(lobe.model);
  if (key != facts.shape_key)
    return InputError("--set " + key + ": a lobe of " + facts.name + " has no " + key +
                      ", allowed is " + facts.shape_key);
  return SetNumber(key, value, facts.least_shape, facts.most_shape,
                   Format("a number from %.10g to %.10g", facts.least_shape, facts.most_shape),
                   lobe.shape);
}

Status SetF0(const std::string& value, estimator::model::Lobe& lobe) {
  const auto& facts = estimator::model::FactsOf(lobe.model);
  if (!facts.physical)
    return InputError(std::string("--set f0: a lobe of ") + facts.name +
                      " has no F0, allowed after --set model=ggx or beckmann");
  constexpr double kLeast = estimator::model::kLeastF0;
  return SetNumber("f0", value, kLeast, 1.0, Format("a number from %.10g to 1", kLeast), lobe.f0);
}

Status SetAlbedo(const std::string& value, Reflectance& reflectance) {
  const auto numbers = ParseNumbers(value, 3);
  for (int c = 0; numbers && c < 3; ++c) {
    if (!((*numbers)[c] >= 0.0) || !std::isfinite((*numbers)[c]))
      return BadValue("albedo", value, "r,g,b of at least 0");
    reflectance.albedo[c] = (*numbers)[c];
  }
  if (!numbers) return BadValue("albedo", value, "r,g,b, such as 0.5,0.4,0.3");
  return {};
}

Status SetRoughness(const std::string& value, Reflectance& reflectance) {
  double degrees = 0.0;
  Status status = SetNumber("roughness_deg", value, 0.0, 90.0, "a number from 0 to 90", degrees);
  if (!status) return status;
  reflectance.roughness = DegToRad(degrees);
  reflectance.diffuse_model = degrees > 0.0 ? DiffuseModel::kOrenNayar : DiffuseModel::kLambert;
  return {};
}

Status SetLight(const std::string& key, const std::string& value, Scene& scene) {
  const std::size_t dot = key.find('.', kPrefix);
  const auto index = ParseNumber(key.substr(kPrefix, dot - kPrefix));
  if (dot == std::string::npos || key.substr(dot) != ".intensity" || !index ||
      *index != std::floor(*index) || *index < 0.0)
    return InputError("--set " + key + ": unknown key, did you mean light.0.intensity?");
  if (!(*index < static_cast<double>(scene.lights.size())))
    return InputError("--set " + key + ": there are " + std::to_string(scene.lights.size()) +
                      " lights, the first is light.0");
  return SetNumber(key, value, 0.0, kInfinity, "a number of at least 0",
                   scene.lights[static_cast<std::size_t>(*index)].intensity);
}

}  // namespace

Status ApplySetting(const std::string& setting, Scene& scene) {
  const std::size_t equals = setting.find('=');
  if (equals == std::string::npos || equals == 0)
    return InputError("--set " + setting + ": allowed is key=value, such as shininess=80");
  const std::string key = setting.substr(0, equals);
  const std::string value = setting.substr(equals + 1);
  const std::string positive = "a number of at least 0";
  Reflectance& reflectance = scene.reflectance;
  if (key == "model") return SetModel(value, reflectance);
  if (key == "albedo") return SetAlbedo(value, reflectance);
  if (key == "ambient") return SetNumber(key, value, 0.0, kInfinity, positive, reflectance.ambient);
  if (key == "diffuse") return SetNumber(key, value, 0.0, kInfinity, positive, reflectance.diffuse);
  if (key == "specular")
    return SetNumber(key, value, 0.0, kInfinity, positive, reflectance.lobes[0].strength);
  if (key == "shininess" || key == "alpha") return SetShape(key, value, reflectance.lobes[0]);
  if (key == "f0") return SetF0(value, reflectance.lobes[0]);
  if (key == "roughness_deg") return SetRoughness(value, reflectance);
  if (key.starts_with("light.")) return SetLight(key, value, scene);
  const std::vector<std::string> keys = {"model",         "albedo",           "ambient", "diffuse",
                                         "specular",      "shininess",        "alpha",   "f0",
                                         "roughness_deg", "light.0.intensity"};
  const std::string nearest = Nearest(key, keys);
  if (!nearest.empty())
    return InputError("--set " + key + ": unknown key, did you mean " + nearest + "?");
  return InputError("--set " + key + ": unknown key, allowed are " + Listed(keys));
}

Result<Light> ParseLight(const std::string& text) {
  const auto numbers = ParseNumbers(text, 5);
  const std::string begin = "--light " + text + ": ";
  if (!numbers)
    return InputError(begin +
                      "allowed are five numbers x,y,z,distance,intensity, such as "
                      "0,0.5,1,900,1; the distance may be inf");
  const Eigen::Vector3d direction((*numbers)[0], (*numbers)[1], (*numbers)[2]);
  const double distance = (*numbers)[3];
  const double intensity = (*numbers)[4];
  if (!direction.allFinite() || !(direction.stableNorm() > 1e-100))
    return InputError(begin + "the direction has no finite length, allowed is any other vector");
  if (!(distance > 0.0)) return InputError(begin + "the distance must be above 0, or inf");
  if (!(intensity >= 0.0) || !std::isfinite(intensity))
    return InputError(begin + "the intensity must be a finite number of at least 0");
  Light light;
  light.direction = direction.stableNormalized();
  light.inverse_distance = 1.0 / distance;
  light.intensity = intensity;
  return light;
}

}  // namespace turnlight::app
