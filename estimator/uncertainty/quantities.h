// The reported quantities as one vector, in which errors are propagated: those of each light, then
// those of the target. Where each stands is told by the tables in quantities.cpp.
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "estimator/uncertainty/reported.h"
#include "estimator/uncertainty/uncertainty.h"

namespace turnlight::estimator::uncertainty {

enum class OfLight {
  kDirection,  // two tangent coordinates at the solution
  kInverseDistance,
  kIntensity,
  kDiffuseProduct,   // R, G, B
  kSpecularProduct,  // of each lobe
  kPosition,
  kDistance,
  kInverseDistanceAtReference,
  kColour,  // R, G, B
};

enum class OfTarget {
  kAlbedo,  // R, G, B
  kAmbient,
  kDiffuse,
  kLobes,  // strength, shape and F0 of each
  kRoughness,
  kAmbientProduct,  // R, G, B
  kHarmonics,
  kAmbientColour,   // R, G, B
  kSpecularColour,  // R, G, B
};

// Where a quantity begins.
Eigen::Index At(OfLight quantity, std::size_t light);
Eigen::Index At(OfTarget quantity, std::size_t lights);
Eigen::Index SizeOf(OfLight quantity);
Eigen::Index SizeOf(OfTarget quantity);
Eigen::Index CountOfQuantities(std::size_t lights);

// at: the solution, which directions are relative to.
Eigen::VectorXd Flatten(const Reported& reported, const Reported& at);

// Standard deviations from variances on the diagonal of a matrix over the vector; NaN where
// `unknown`. Those of directions and positions, which are of matrices, are not set.
void TakeSigmas(const Eigen::MatrixXd& covariance, const std::vector<bool>& unknown,
                std::size_t lights, Uncertainty& out);

}  // namespace turnlight::estimator::uncertainty
