// The parameters of a scene as the columns of the normal equations: where each stands, its
// coordinate, and a step in it.
#pragma once

#include <Eigen/Core>

#include "estimator/model/scene.h"

namespace turnlight::estimator::solve {

// Where each parameter's row and column stand. Shininess is in log; Oren-Nayar's roughness by its
// square, for the model is even in it and a start at 0 would not move; directions are two tangent
// coordinates in TangentBasis(u); inverse distances are in units of 1/R, as all of a Scene here.
struct Columns {
  int channels = 3;
  int lights = 0;

  int Albedo(int channel) const { return channel; }
  int Ambient() const { return channels; }
  int Diffuse() const { return channels + 1; }
  int Specular() const { return channels + 2; }
  int LogShininess() const { return channels + 3; }
  int RoughnessSquared() const { return channels + 4; }
  int Intensity(int light) const { return channels + 5 + 4 * light; }
  int Tangent(int light) const { return Intensity(light) + 1; }  // and the next
  int InverseDistance(int light) const { return Intensity(light) + 3; }
  int count() const { return channels + 5 + 4 * lights; }
};

// Bounds of the solver's coordinates (design, section 3), besides those of shininess.
inline constexpr double kMaxRoughness = 1.5707963;   // radians of facet slope
inline constexpr double kMaxInverseDistance = 0.95;  // in 1/R: a light stays outside the target

// The value of each column; tangents are relative to the direction, so theirs are 0.
Eigen::VectorXd Values(const model::Scene& scene, const Columns& columns);

// The scene moved by a step in the columns' coordinates; directions along their tangents.
model::Scene Moved(const model::Scene& scene, const Columns& columns, const Eigen::VectorXd& step);

// The nearest scene within the bounds.
model::Scene WithinBounds(model::Scene scene);

}  // namespace turnlight::estimator::solve
