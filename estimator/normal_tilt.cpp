#include "estimator/normal_tilt.h"

#include <Eigen/Geometry>

namespace turnlight::estimator {
namespace {

constexpr std::size_t kPixels = 50000;
constexpr double kStep = 1e-3;  // radians

// Normals and mirrored directions as if the target's normals were turned.
Observations Tilted(const Observations& all, int axis, double angle) {
  Observations out = all;
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(angle, Eigen::Vector3d::Unit(axis)).toRotationMatrix();
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all.pixel[i] == Observations::kNoPixel) continue;
    const auto vector = [i](const std::array<std::vector<float>, 3>& from) {
      return Eigen::Vector3d(static_cast<double>(from[0][i]), static_cast<double>(from[1][i]),
                             static_cast<double>(from[2][i]));
    };
    const Eigen::Vector3d n = vector(all.normal), w = vector(all.mirrored);
    Eigen::Matrix3d in_W = turn;
    if (all.caster != nullptr) {
      const Eigen::Matrix3d& R_TW = all.X_TW[all.keyframe[i]].rotation;
      in_W = R_TW.transpose() * turn * R_TW;
    }
    // A mean normal is a little shorter than one; the view is mirrored about its direction.
    const Eigen::Vector3d unit = n.normalized();
    const Eigen::Vector3d viewer = 2.0 * unit.dot(w) * unit - w;
    const Eigen::Vector3d turned = in_W * n, turned_unit = in_W * unit;
    const Eigen::Vector3d mirrored = 2.0 * turned_unit.dot(viewer) * turned_unit - viewer;
    for (int k = 0; k < 3; ++k) {
      out.normal[static_cast<std::size_t>(k)][i] = static_cast<float>(turned[k]);
      out.mirrored[static_cast<std::size_t>(k)][i] = static_cast<float>(mirrored[k]);
    }
  }
  return out;
}

}  // namespace

TiltResponses TiltNormals(const Observations& observations, const Solution& solution) {
  const Observations sample = Subsample(observations, kPixels, 3);
  EvaluateOptions options;
  options.huber = solution.evaluate.huber;
  options.samples_per_side = FootprintSamples(sample, solution.scene.reflectance.shininess);
  options.shadows = CastShadows(sample, solution.scene);
  TiltResponses out;
  out.untilted = Evaluate(sample, solution.scene, options);
  options.gradient_only = true;
  for (int axis = 0; axis < 3; ++axis) {
    const auto at = [&](double angle) {
      return Evaluate(Tilted(sample, axis, angle), solution.scene, options);
    };
    const NormalEquations up = at(kStep), down = at(-kStep);
    TiltResponse& response = out.axes[static_cast<std::size_t>(axis)];
    response.mixed = (up.gradient - down.gradient) / (2.0 * kStep);
    response.slope = (up.cost - down.cost) / (2.0 * kStep);
    response.curvature = (up.cost + down.cost - 2.0 * out.untilted.cost) / (kStep * kStep);
  }
  return out;
}

}  // namespace turnlight::estimator
