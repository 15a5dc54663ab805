// The parameters of a scene, in one table: what each is called, its chart (the coordinate that a
// fit steps in), its bounds, its longest step, and where it stands. The normal equations' columns
// are in this order, and whatever needs all of them loops over it.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "estimator/model/scene.h"

namespace turnlight::estimator::model {

enum class ParameterKind {
  kAlbedo,     // O of a channel
  kAmbient,    // k_a
  kHarmonic,   // h of a spherical harmonic; the ambient light's
  kDiffuse,    // k_d
  kStrength,   // k_s of a lobe
  kShape,      // its exponent or alpha; logarithm
  kF0,         // its F0
  kShading,    // d of a spherical harmonic; the diffuse part's departures
  kRoughness,  // of the diffuse model; by its square, for the model is even in it, and a start
               // at 0 would not move
  kIntensity,  // I of a light
  kTangent,    // of a light's direction along one axis of TangentBasis(u)
  kInverseDistance,  // rho of a light, in units of 1/R
  kColour,           // of a light in a channel
  kAmbientColour,    // in a channel
  kSpecularColour,   // in a channel
};

struct Parameter {
  ParameterKind kind;
  int owner = 0;  // channel, lobe, light or harmonic
  int part = 0;   // axis of a tangent, channel of a colour
};

// What a fit may do with one parameter, in its chart.
struct ParameterLimits {
  double low = 0.0;
  double high = 0.0;
  double step = 0.0;  // the linear model reaches no further than this in one step
};

inline constexpr double kMaxRoughness = 1.5707963;   // radians of facet slope
inline constexpr double kMaxInverseDistance = 0.95;  // in 1/R: a light stays outside the target

class Parameters {
 public:
  // Of a scene with so many channels (1 or 3): those that its models have. The first lobe and the
  // roughness have theirs also where there is none; a fit holds them.
  Parameters(const Scene& scene, int channels);

  int count() const { return static_cast<int>(list_.size()); }
  int channels() const { return channels_; }
  int lobes() const { return lobes_; }
  int lights() const { return lights_; }
  const Parameter& operator[](int column) const { return list_[static_cast<std::size_t>(column)]; }

  // Where one stands; -1 if the scene has it not.
  int Find(ParameterKind kind, int owner = 0, int part = 0) const;

  int Albedo(int channel) const { return Find(ParameterKind::kAlbedo, channel); }
  int Ambient() const { return Find(ParameterKind::kAmbient); }
  int Harmonic(int j) const { return Find(ParameterKind::kHarmonic, j); }
  int Diffuse() const { return Find(ParameterKind::kDiffuse); }
  int Strength(int lobe) const { return Find(ParameterKind::kStrength, lobe); }
  int Shape(int lobe) const { return Find(ParameterKind::kShape, lobe); }
  int F0(int lobe) const { return Find(ParameterKind::kF0, lobe); }
  int Shading(int j) const { return Find(ParameterKind::kShading, j); }
  int Roughness() const { return Find(ParameterKind::kRoughness); }
  int FirstLight() const { return first_light_; }  // its intensity; also where there is none
  int Intensity(int light) const { return Find(ParameterKind::kIntensity, light); }
  int Tangent(int light) const { return Find(ParameterKind::kTangent, light); }  // and the next
  int InverseDistance(int light) const { return Find(ParameterKind::kInverseDistance, light); }
  int AmbientColour(int channel) const { return Find(ParameterKind::kAmbientColour, channel); }
  int SpecularColour(int channel) const { return Find(ParameterKind::kSpecularColour, channel); }
  int Colour(int light, int channel) const { return Find(ParameterKind::kColour, light, channel); }

 private:
  std::vector<Parameter> list_;
  int channels_, lobes_, lights_, first_light_ = 0;
};

// "shininess", "direction of light 2": for people, by what they see in results.
std::string NameOf(const Parameter& parameter, const Scene& scene);
// A light's inverse distance, where distances are known, has the bounds of its own direction.
ParameterLimits LimitsOf(const Parameter& parameter, const Scene& scene);

// The value of each parameter in its chart; tangents are relative to the direction, so theirs are
// 0.
Eigen::VectorXd Values(const Scene& scene, const Parameters& parameters);

// The scene moved by a step in the charts; directions along their tangents.
Scene Moved(const Scene& scene, const Parameters& parameters, const Eigen::VectorXd& step);

// The nearest scene within the bounds.
Scene WithinBounds(Scene scene);

}  // namespace turnlight::estimator::model
