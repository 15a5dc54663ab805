#include "estimator/model/parameters.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "estimator/model/tangent_basis.h"

namespace turnlight::estimator::model {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

enum class Chart { kLinear, kLogarithm, kSquare, kTangent };

struct Row {
  ParameterKind kind;
  const char* name;
  Chart chart;
  double low, high;  // of the value itself; a shape's are those of its model
  double step;       // in the chart
};

// In the order of ParameterKind.
constexpr Row kTable[] = {
    {ParameterKind::kAlbedo, "albedo", Chart::kLinear, 0.0, kInfinity, kInfinity},
    {ParameterKind::kAmbient, "ambient", Chart::kLinear, 0.0, kInfinity, kInfinity},
    {ParameterKind::kHarmonic, "ambient harmonic", Chart::kLinear, -kInfinity, kInfinity,
     kInfinity},
    {ParameterKind::kDiffuse, "diffuse", Chart::kLinear, 0.0, kInfinity, kInfinity},
    {ParameterKind::kStrength, "specular", Chart::kLinear, 0.0, kInfinity, kInfinity},
    {ParameterKind::kShape, "", Chart::kLogarithm, 0.0, kInfinity, 1.0},
    {ParameterKind::kF0, "f0", Chart::kLinear, kLeastF0, 1.0, 0.3},
    {ParameterKind::kShading, "diffuse harmonic", Chart::kLinear, -kInfinity, kInfinity, kInfinity},
    {ParameterKind::kRoughness, "roughness", Chart::kSquare, 0.0, kMaxRoughness, 0.2},
    {ParameterKind::kIntensity, "intensity", Chart::kLinear, 0.0, kInfinity, kInfinity},
    {ParameterKind::kTangent, "direction", Chart::kTangent, -kInfinity, kInfinity, 0.3},
    {ParameterKind::kInverseDistance, "distance", Chart::kLinear, 0.0, kMaxInverseDistance, 0.1},
    {ParameterKind::kColour, "colour", Chart::kLinear, 0.0, kInfinity, kInfinity},
    {ParameterKind::kAmbientColour, "ambient colour", Chart::kLinear, 0.0, kInfinity, kInfinity},
    {ParameterKind::kSpecularColour, "specular colour", Chart::kLinear, 0.0, kInfinity, kInfinity},
};

const Row& RowOf(ParameterKind kind) { return kTable[static_cast<std::size_t>(kind)]; }

static_assert([] {
  for (std::size_t i = 0; i < std::size(kTable); ++i)
    if (static_cast<std::size_t>(kTable[i].kind) != i) return false;
  return true;
}());

// The number itself; none of a tangent.
double* At(const Parameter& parameter, Scene& scene) {
  const auto owner = static_cast<std::size_t>(parameter.owner);
  Reflectance& r = scene.reflectance;
  switch (parameter.kind) {
    case ParameterKind::kAlbedo:
      return &r.albedo[parameter.owner];
    case ParameterKind::kAmbient:
      return &r.ambient;
    case ParameterKind::kHarmonic:
      return &r.harmonics[parameter.owner];
    case ParameterKind::kShading:
      return &r.shading[parameter.owner];
    case ParameterKind::kDiffuse:
      return &r.diffuse;
    case ParameterKind::kStrength:
      return &r.lobes[owner].strength;
    case ParameterKind::kShape:
      return &r.lobes[owner].shape;
    case ParameterKind::kF0:
      return &r.lobes[owner].f0;
    case ParameterKind::kRoughness:
      return &r.roughness;
    case ParameterKind::kIntensity:
      return &scene.lights[owner].intensity;
    case ParameterKind::kInverseDistance:
      return &scene.lights[owner].inverse_distance;
    case ParameterKind::kColour:
      return &scene.lights[owner].color[parameter.part];
    case ParameterKind::kAmbientColour:
      return &r.ambient_colour[parameter.owner];
    case ParameterKind::kSpecularColour:
      return &r.specular_colour[parameter.owner];
    case ParameterKind::kTangent:
      break;
  }
  return nullptr;
}

double ToChart(Chart chart, double value) {
  switch (chart) {
    case Chart::kLinear:
      return value;
    case Chart::kLogarithm:
      return std::log(value);
    case Chart::kSquare:
      return value * value;
    case Chart::kTangent:
      break;
  }
  return 0.0;
}

// The value of which the chart's is `step` further.
double Stepped(Chart chart, double value, double step) {
  switch (chart) {
    case Chart::kLinear:
      return value + step;
    case Chart::kLogarithm:
      return value * std::exp(step);
    case Chart::kSquare:
      return step != 0.0 ? std::sqrt(std::max(value * value + step, 0.0)) : value;
    case Chart::kTangent:
      break;
  }
  return value;
}

// The inverse distance at which the light from there is so far from a point: |u / rho - p| = d.
double InverseDistanceAt(const Eigen::Vector3d& direction, const Eigen::Vector3d& point,
                         double distance) {
  const double along = direction.dot(point);
  return 1.0 / (along + std::sqrt(std::max(
                            along * along + distance * distance - point.squaredNorm(), 0.0)));
}

// The bounds of the value itself.
std::pair<double, double> BoundsOf(const Parameter& parameter, const Scene& scene) {
  if (parameter.kind == ParameterKind::kInverseDistance && scene.distance.known()) {
    const DistanceRange& range = scene.distance;
    const Eigen::Vector3d& u = scene.lights[static_cast<std::size_t>(parameter.owner)].direction;
    return {InverseDistanceAt(u, range.from, range.most),
            InverseDistanceAt(u, range.from, range.least)};
  }
  if (parameter.kind == ParameterKind::kShape) {
    const auto& facts =
        FactsOf(scene.reflectance.lobes[static_cast<std::size_t>(parameter.owner)].model);
    return {facts.least_shape, facts.most_shape};
  }
  const Row& row = RowOf(parameter.kind);
  return {row.low, row.high};
}

}  // namespace

Parameters::Parameters(const Scene& scene, int channels)
    : channels_(channels), lobes_(1), lights_(static_cast<int>(scene.lights.size())) {
  using enum ParameterKind;
  const auto& lobes = scene.reflectance.lobes;
  while (lobes_ < static_cast<int>(kMostLobes) && lobes[static_cast<std::size_t>(lobes_)].present())
    ++lobes_;
  const auto add_f0 = [&](int lobe) {
    const Lobe& of = lobes[static_cast<std::size_t>(lobe)];
    if (of.present() && FactsOf(of.model).physical) list_.push_back({kF0, lobe});
  };
  for (int c = 0; c < channels; ++c) list_.push_back({kAlbedo, c});
  list_.insert(list_.end(), {{kAmbient}, {kDiffuse}, {kStrength}, {kShape}, {kRoughness}});
  add_f0(0);
  for (int lobe = 1; lobe < lobes_; ++lobe) {
    list_.insert(list_.end(), {{kStrength, lobe}, {kShape, lobe}});
    add_f0(lobe);
  }
  for (int j = 0; scene.free_harmonics && j < kHarmonics; ++j) list_.push_back({kHarmonic, j});
  for (int j = 0; scene.free_shading && j < kHarmonics; ++j) list_.push_back({kShading, j});
  first_light_ = count();
  for (int l = 0; l < lights_; ++l)
    list_.insert(list_.end(),
                 {{kIntensity, l}, {kTangent, l, 0}, {kTangent, l, 1}, {kInverseDistance, l}});
  if (!scene.free_colours || channels == 1) return;
  for (int l = 0; l < lights_; ++l)
    for (int c = 0; c < channels; ++c) list_.push_back({kColour, l, c});
  for (int c = 0; c < channels; ++c) list_.push_back({kAmbientColour, c});
  for (int c = 0; c < channels && lobes[0].present(); ++c) list_.push_back({kSpecularColour, c});
}

int Parameters::Find(ParameterKind kind, int owner, int part) const {
  for (std::size_t i = 0; i < list_.size(); ++i)
    if (list_[i].kind == kind && list_[i].owner == owner && list_[i].part == part)
      return static_cast<int>(i);
  return -1;
}

std::string NameOf(const Parameter& parameter, const Scene& scene) {
  static const char* const kColours[] = {"red", "green", "blue"};
  const std::string name = RowOf(parameter.kind).name;
  const std::string number = std::to_string(parameter.owner + 1);
  const std::string of_lobe = parameter.owner > 0 ? " of lobe " + number : "";
  switch (parameter.kind) {
    case ParameterKind::kAlbedo:
      return name + " " + kColours[parameter.owner];
    case ParameterKind::kShape:
      return FactsOf(scene.reflectance.lobes[static_cast<std::size_t>(parameter.owner)].model)
                 .shape_key +
             of_lobe;
    case ParameterKind::kHarmonic:
    case ParameterKind::kShading:
      return name + " " + number;
    case ParameterKind::kStrength:
    case ParameterKind::kF0:
      return name + of_lobe;
    case ParameterKind::kIntensity:
    case ParameterKind::kTangent:
    case ParameterKind::kInverseDistance:
    case ParameterKind::kColour:
      return name + " of light " + number;
    default:
      return name;
  }
}

ParameterLimits LimitsOf(const Parameter& parameter, const Scene& scene) {
  const Row& row = RowOf(parameter.kind);
  if (row.chart == Chart::kTangent) return {row.low, row.high, row.step};
  const auto [low, high] = BoundsOf(parameter, scene);
  return {ToChart(row.chart, low), ToChart(row.chart, high), row.step};
}

Eigen::VectorXd Values(const Scene& scene, const Parameters& parameters) {
  Scene own = scene;
  Eigen::VectorXd out = Eigen::VectorXd::Zero(parameters.count());
  for (int i = 0; i < parameters.count(); ++i)
    if (const double* value = At(parameters[i], own))
      out[i] = ToChart(RowOf(parameters[i].kind).chart, *value);
  return out;
}

Scene Moved(const Scene& scene, const Parameters& parameters, const Eigen::VectorXd& step) {
  Scene out = scene;
  for (int i = 0; i < parameters.count(); ++i) {
    const Parameter& parameter = parameters[i];
    if (double* value = At(parameter, out))
      *value = Stepped(RowOf(parameter.kind).chart, *value, step[i]);
    if (parameter.kind != ParameterKind::kTangent || parameter.part != 0) continue;
    Eigen::Vector3d& direction = out.lights[static_cast<std::size_t>(parameter.owner)].direction;
    direction = (direction + TangentBasis(direction) * step.segment<2>(i)).normalized();
  }
  if (parameters.channels() == 1) out.reflectance.albedo.setConstant(out.reflectance.albedo[0]);
  return out;
}

Scene WithinBounds(Scene scene) {
  const Parameters parameters(scene, 3);
  for (int i = 0; i < parameters.count(); ++i)
    if (double* value = At(parameters[i], scene)) {
      const auto [low, high] = BoundsOf(parameters[i], scene);
      *value = std::min(std::max(*value, low), high);
    }
  return scene;
}

}  // namespace turnlight::estimator::model
