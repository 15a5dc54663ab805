// How the errors of what is reported go together: correlations of sigma_total, all of its parts
// included, in the words and units of results.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "estimator/uncertainty/reported.h"

namespace turnlight::estimator::uncertainty {

struct CorrelatedQuantity {
  std::string quantity;              // "direction", "albedo", "shininess"
  std::string part;                  // "azimuth", "red"; "" of what is one number
  std::optional<std::size_t> light;  // of which light; else of the target
  double sigma = 0.0;                // > 0, of degrees where it is an angle

  // For people, as `weak` names quantities: "direction of light 1, azimuth".
  std::string name() const;
};

// A matrix of more rows is in no file and no picture: both grow with their square, and so many take
// half a megabyte of text.
inline constexpr std::size_t kMostCorrelated = 200;

struct Correlation {
  std::vector<CorrelatedQuantity> quantities;  // light by light, then the target
  Eigen::MatrixXd matrix;                      // symmetric, in [-1, 1], exactly 1 on the diagonal
};

// Of a covariance of the vector in quantities.h, NaN where the data do not determine a quantity.
// Those have no row, nor have quantities without an error: what the gauge holds, what the model has
// not. A direction's two coordinates are arcs on the unit sphere of W, towards a larger azimuth,
// (-sin a, cos a, 0), and towards a larger zenith angle, (cos z cos a, cos z sin a, -sin z); at the
// poles a is 0. A near light has its distance, a distant one its inverse distance; positions, whose
// covariance results have beside them, have no rows. channels: 1 or 3; of grey pictures, whose
// channels repeat one value, the first stands for all.
Correlation CorrelationOf(const Eigen::MatrixXd& covariance, const Reported& at, int channels);

// The same without a light; those after it count one less.
Correlation WithoutLight(const Correlation& correlation, std::size_t light);

}  // namespace turnlight::estimator::uncertainty
