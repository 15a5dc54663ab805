// What the model holds fixed or leaves out, and what the pictures say of it: how the cost answers
// when it is let in a little, alone.
#pragma once

#include <Eigen/Core>
#include <array>
#include <numbers>
#include <optional>
#include <vector>

#include "estimator/observe/observations.h"
#include "estimator/solve/solver.h"
#include "estimator/uncertainty/score_test.h"

namespace turnlight::estimator::uncertainty {

// The angle of an axis, radians, in the tangent plane of a light's direction (TangentBasis).
inline double ExtentAxis(std::size_t axis) {
  return static_cast<double>(axis) * std::numbers::pi / 3.0;
}

struct Unmodelled {
  solve::NormalEquations as_modelled;  // of the same pixels
  std::array<Score, 3> tilts;          // of all normals, together
  // The scene as it is with the tilt that the pictures ask for, if that explains much of the
  // residual: then it is too large for derivatives.
  std::optional<model::Scene> tilted_scene;
  Score aperture;  // of the pixels, as a share of EvaluateOptions::aperture
  // Of each light: it is no point, or two lights are taken for one. Its variance (radians^2) along
  // each of three axes across its direction (ExtentAxis); at least 0.
  std::vector<std::array<Score, 3>> extents;
  // The intensity, at least 0, of one more light: of those of many directions the one that would
  // lower the cost the most. None if none would.
  std::optional<Score> light;
  Eigen::Vector3d light_direction = Eigen::Vector3d::UnitZ();
  // By how much the gradient changes when a near light's falloff and the shading with it are
  // averaged over the pixels instead of taken at their centres.
  Eigen::VectorXd falloff;
  // The variance (radians^2, along an axis across) of normals that are wrong each by itself, as
  // those of a noisy scan: the residual is larger where tilts change the picture more. 0 if that is
  // not beyond noise.
  double normal_variance = 0.0;
};

// On at most 50 000 of the pixels.
Unmodelled TryUnmodelled(const observe::Observations& observations,
                         const solve::Solution& solution);

}  // namespace turnlight::estimator::uncertainty
