#include "estimator/results/reported_result.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "base/strict_object.h"

namespace turnlight::estimator::results {
namespace {

// Everything of a result but its method may be null, where the data do not determine it.
std::optional<double> NumberOrNull(StrictObject& object, const std::string& key) {
  if (object.Has(key) && object.Raw(key).is_null()) return std::nullopt;
  return object.OptionalNumber(key);
}

MeasuredValue MeasuredOf(StrictObject& values, const std::string& key, StrictObject& sigmas,
                         const std::string& sigma_key) {
  return {NumberOrNull(values, key), NumberOrNull(sigmas, sigma_key)};
}

// Numbers or nulls; none of a missing list.
std::vector<std::optional<double>> ListOrNull(StrictObject& object, const std::string& key) {
  std::vector<std::optional<double>> out;
  const nlohmann::json& list = object.Raw(key);
  if (list.is_null()) return out;
  if (!list.is_array()) object.Refuse(key, "a list of numbers or nulls");
  for (const nlohmann::json& value : list) {
    if (!value.is_number() && !value.is_null()) object.Refuse(key, "a list of numbers or nulls");
    out.push_back(value.is_number() ? std::optional(value.get<double>()) : std::nullopt);
  }
  return out;
}

// A list and the one of its sigmas, which may be missing.
std::vector<MeasuredValue> MeasuredList(StrictObject& values, const std::string& key,
                                        StrictObject& sigmas, const std::string& sigma_key) {
  const auto value = ListOrNull(values, key), sigma = ListOrNull(sigmas, sigma_key);
  std::vector<MeasuredValue> out;
  if (!sigma.empty() && sigma.size() != value.size())
    sigmas.Refuse(sigma_key, "a list with one element for each of " + key);
  else
    for (std::size_t i = 0; i < value.size(); ++i)
      out.push_back({value[i], sigma.empty() ? std::nullopt : sigma[i]});
  return out;
}

// [r, g, b] of numbers or nulls; nothing of a missing or null list.
std::array<std::optional<double>, 3> ThreeOrNull(StrictObject& object, const std::string& key,
                                                 const nlohmann::json& list) {
  std::array<std::optional<double>, 3> three;
  if (list.is_null()) return three;
  if (!list.is_array() || list.size() != three.size()) {
    object.Refuse(key, "a list of 3 numbers or nulls");
    return three;
  }
  for (std::size_t i = 0; i < three.size(); ++i) {
    if (list[i].is_number())
      three[i] = list[i].get<double>();
    else if (!list[i].is_null())
      object.Refuse(key, "a list of 3 numbers or nulls");
  }
  return three;
}

MeasuredColour ColourOf(StrictObject& values, const std::string& key, StrictObject& sigmas,
                        const std::string& sigma_key) {
  const auto value = ThreeOrNull(values, key, values.Raw(key));
  const auto sigma = ThreeOrNull(sigmas, sigma_key, sigmas.Raw(sigma_key));
  MeasuredColour colour;
  for (std::size_t i = 0; i < colour.size(); ++i) colour[i] = {value[i], sigma[i]};
  return colour;
}

std::optional<MeasuredColour> ColourIfThere(StrictObject& values, StrictObject& sigmas,
                                            const std::string& key) {
  return values.Has(key) ? std::optional(ColourOf(values, key, sigmas, key)) : std::nullopt;
}

// frames: those that the result says it is of; none: it does not say.
std::vector<ReportedFactor> ReadFactors(StrictObject& object,
                                        const std::vector<std::size_t>& frames) {
  const std::vector<MeasuredValue> list = MeasuredList(object, "factors", object, "factors_sigma");
  const bool has_sigmas = object.Has("factors_sigma");
  if (!frames.empty() && !list.empty() && list.size() != frames.size())
    object.Refuse("factors", "a list with one element for each of frames");
  std::vector<ReportedFactor> out;
  for (std::size_t k = 0; k < list.size() && object.ok(); ++k) {
    out.push_back({frames.empty() ? k : frames[k], list[k]});
    if (has_sigmas && !list[k].sigma) out.back().factor.value.reset();
  }
  return out;
}

Result<ReportedLight> ReadReportedLight(StrictObject object,
                                        const std::vector<std::size_t>& frames) {
  ReportedLight light;
  const std::vector<double> direction = object.Numbers("direction", 3);
  light.direction = Eigen::Vector3d(direction[0], direction[1], direction[2]);
  if (object.ok() && !(light.direction.stableNorm() > 1e-100))
    object.RefuseText("direction", "it has no length, allowed is any other vector");
  if (object.ok()) light.direction = light.direction.stableNormalized();
  light.direction_sigma_deg = NumberOrNull(object, "direction_sigma_deg");
  light.inverse_distance = MeasuredOf(object, "inverse_distance", object, "inverse_distance_sigma");
  light.distance = MeasuredOf(object, "distance", object, "distance_sigma");
  light.intensity = MeasuredOf(object, "intensity", object, "intensity_sigma");
  if (const auto colour = object.OptionalNumbers("color", 3))
    light.colour = {(*colour)[0], (*colour)[1], (*colour)[2]};
  light.colour_sigma = ThreeOrNull(object, "color_sigma", object.Raw("color_sigma"));
  light.factors = ReadFactors(object, frames);
  object.AllowUnknown();
  if (Status status = object.Finish(); !status) return Forward(status);
  return light;
}

Status ReadReportedModel(StrictObject object, ReportedResult& result) {
  result.diffuse_model = object.String("diffuse");
  result.specular_model = object.String("specular");
  result.albedo_model = object.OptionalString("albedo").value_or("uniform");
  const nlohmann::json& near = object.Raw("near");
  if (!near.is_array() || near.size() != result.lights.size())
    object.Refuse("near", "a list of true or false, one for each light");
  else
    for (std::size_t i = 0; i < near.size(); ++i) {
      if (!near[i].is_boolean())
        object.Refuse("near", "a list of true or false, one for each light");
      else
        result.lights[i].near = near[i].get<bool>();
    }
  object.AllowUnknown();
  return object.Finish();
}

Result<ReportedLobe> ReadReportedLobe(StrictObject object) {
  ReportedLobe lobe;
  lobe.model = object.String("model");
  StrictObject sigma = object.Object("sigma");
  lobe.specular = MeasuredOf(object, "specular", sigma, "specular");
  lobe.shininess = MeasuredOf(object, "shininess", sigma, "shininess");
  lobe.alpha = MeasuredOf(object, "alpha", sigma, "alpha");
  lobe.f0 = MeasuredOf(object, "f0", sigma, "f0");
  sigma.AllowUnknown();
  object.AllowUnknown();
  Status status = sigma.Finish();
  if (status) status = object.Finish();
  if (!status) return Forward(status);
  return lobe;
}

// Of the list of lobes, where there is one: what the first has beside the keys that all have, and
// the second.
Status ReadReportedLobes(StrictObject& reflectance, ReportedResult& result) {
  if (!reflectance.Has("lobes")) return {};
  std::vector<StrictObject> lobes = reflectance.Objects("lobes", 1);
  for (std::size_t k = 0; k < std::min<std::size_t>(lobes.size(), 2); ++k) {
    auto lobe = ReadReportedLobe(std::move(lobes[k]));
    if (!lobe) return Forward(lobe);
    if (k == 0) {
      result.alpha = lobe->alpha;
      result.f0 = lobe->f0;
    } else {
      result.second_lobe = std::move(*lobe);
    }
  }
  return {};
}

Status ReadReportedReflectance(StrictObject object, ReportedResult& result) {
  StrictObject sigma = object.Object("sigma");
  result.albedo = ColourOf(object, "albedo", sigma, "albedo");
  result.ambient = MeasuredOf(object, "ambient", sigma, "ambient");
  result.diffuse = MeasuredOf(object, "diffuse", sigma, "diffuse");
  result.specular = MeasuredOf(object, "specular", sigma, "specular");
  result.shininess = MeasuredOf(object, "shininess", sigma, "shininess");
  result.roughness_deg = MeasuredOf(object, "roughness_deg", sigma, "roughness_deg");
  result.ambient_harmonics = MeasuredList(object, "ambient_harmonics", sigma, "ambient_harmonics");
  result.diffuse_harmonics = MeasuredList(object, "diffuse_harmonics", sigma, "diffuse_harmonics");
  result.ambient_colour = ColourIfThere(object, sigma, "ambient_color");
  result.specular_colour = ColourIfThere(object, sigma, "specular_color");
  object.Adopt(ReadReportedLobes(object, result));
  sigma.AllowUnknown();
  object.AllowUnknown();
  const Status status = sigma.Finish();
  return status ? object.Finish() : status;
}

// The i-th element of a list; null of a missing list.
const nlohmann::json& Element(StrictObject& object, const std::string& key, std::size_t i,
                              std::size_t count) {
  static const nlohmann::json kNull;
  const nlohmann::json& list = object.Raw(key);
  if (list.is_null()) return kNull;
  if (list.is_array() && list.size() == count) return list[i];
  object.Refuse(key, "a list with one element for each light");
  return kNull;
}

Status ReadProducts(StrictObject object, ReportedResult& result) {
  result.ambient_product = ColourOf(object, "ambient", object, "ambient_sigma");
  const std::size_t count = result.lights.size();
  const auto number = [&](const std::string& key, std::size_t i) {
    const nlohmann::json& value = Element(object, key, i, count);
    if (!value.is_null() && !value.is_number()) object.Refuse(key, "a list of numbers or nulls");
    return value.is_number() ? std::optional(value.get<double>()) : std::nullopt;
  };
  for (std::size_t i = 0; i < count; ++i) {
    ReportedLight& light = result.lights[i];
    const auto value = ThreeOrNull(object, "diffuse", Element(object, "diffuse", i, count));
    const auto sigma =
        ThreeOrNull(object, "diffuse_sigma", Element(object, "diffuse_sigma", i, count));
    for (std::size_t c = 0; c < value.size(); ++c) light.diffuse_product[c] = {value[c], sigma[c]};
    light.specular_product = {number("specular", i), number("specular_sigma", i)};
  }
  object.AllowUnknown();
  return object.Finish();
}

// The frames that the result says its factors are of.
std::vector<std::size_t> ReadFrames(StrictObject& object) {
  std::vector<std::size_t> frames;
  const nlohmann::json& list = object.Raw("frames");
  if (list.is_null()) return frames;
  if (!list.is_array()) object.Refuse("frames", "a list of numbers of frames");
  for (const nlohmann::json& frame : list) {
    if (!frame.is_number_unsigned()) {
      object.Refuse("frames", "a list of numbers of frames");
      break;
    }
    frames.push_back(frame.get<std::size_t>());
  }
  return frames;
}

}  // namespace

Result<ReportedResult> ParseReportedResult(const std::string& text, const std::string& file) {
  const auto document = ParseJson(text, file);
  if (!document) return Forward(document);
  StrictObject object(*document);
  object.Choice("format", {"turnlight-result"});
  object.Integer("version", 1, 1);
  ReportedResult result;
  result.method = object.String("method");
  const std::vector<std::size_t> frames = ReadFrames(object);
  if (!object.ok()) return Forward(object.Finish());
  for (StrictObject& entry : object.Objects("lights", 0)) {
    auto light = ReadReportedLight(std::move(entry), frames);
    if (!light) return Forward(light);
    result.lights.push_back(std::move(*light));
  }
  StrictObject model = object.Object("model");
  StrictObject reflectance = object.Object("reflectance");
  StrictObject products = object.Object("products");
  StrictObject residual = object.Object("residual");
  object.AllowUnknown();
  if (Status status = object.Finish(); !status) return Forward(status);
  if (Status status = ReadReportedModel(std::move(model), result); !status) return Forward(status);
  if (Status status = ReadReportedReflectance(std::move(reflectance), result); !status)
    return Forward(status);
  if (Status status = ReadProducts(std::move(products), result); !status) return Forward(status);
  result.rms = residual.Number("rms");
  residual.AllowUnknown();
  if (Status status = residual.Finish(); !status) return Forward(status);
  return result;
}

}  // namespace turnlight::estimator::results
