// What a result.json says, as values: what `turnlight compare` looks at. Keys that are not known
// are passed over (result_json.h has the rule).
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "base/comparison.h"
#include "base/result.h"

namespace turnlight::estimator::results {

// R, G, B.
using MeasuredColour = std::array<MeasuredValue, 3>;

// How many times its intensity a light has in a frame. Those whose factor is not determined, as the
// frame does not see the light, have no sigma.
struct ReportedFactor {
  std::size_t frame = 0;  // as the session counts them; of results that do not say, as they come
  MeasuredValue factor;
};

struct ReportedLight {
  bool near = false;
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  // unit, from W's origin
  std::optional<double> direction_sigma_deg;
  MeasuredValue inverse_distance, distance, intensity;
  std::optional<std::array<double, 3>> colour;  // nothing: white
  std::array<std::optional<double>, 3> colour_sigma;
  MeasuredColour diffuse_product;
  MeasuredValue specular_product;
  std::vector<ReportedFactor> factors;  // none: the light is constant
};

struct ReportedLobe {
  std::string model;
  MeasuredValue specular, shininess, alpha, f0;  // those that it has
};

struct ReportedResult {
  std::string method, diffuse_model, specular_model, albedo_model;
  std::vector<ReportedLight> lights;  // in the file's order: strongest first
  MeasuredColour albedo;
  MeasuredValue ambient, diffuse, specular, shininess, roughness_deg;
  MeasuredValue alpha, f0;                  // of the first lobe, if it has them
  std::optional<ReportedLobe> second_lobe;  // beside the first
  std::vector<MeasuredValue> ambient_harmonics, diffuse_harmonics;  // none: there are no departures
  MeasuredColour ambient_product;
  std::optional<MeasuredColour> ambient_colour, specular_colour;  // nothing: white
  double rms = 0.0;
};

// file is only for messages. Fails (kInput): no result of version 1, a key that is missing or of
// the wrong kind, lists that do not have an element for each light.
Result<ReportedResult> ParseReportedResult(const std::string& text, const std::string& file);

}  // namespace turnlight::estimator::results
