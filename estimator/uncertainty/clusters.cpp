#include "estimator/uncertainty/clusters.h"

#include <algorithm>
#include <cmath>

namespace turnlight::estimator::uncertainty {
namespace {

constexpr double kChanceSigmas = 3.0;  // what noise alone may show
// A variance that is larger by this counts, from however few clusters it was estimated.
constexpr double kMostChanceInflation = 4.0;
// Of the squares' number: what counts of it at least where there are many unknowns.
constexpr double kLeastFree = 0.25;

// Of the unknowns, one column a cluster. `fewer`: freedoms that as many clusters lack.
Eigen::MatrixXd Corrected(const Eigen::MatrixXd& gradients, const Covariance& covariance,
                          double fewer) {
  const double count = static_cast<double>(gradients.cols());
  const double free = std::max({count - fewer, kLeastFree * count, 1.0});
  return gradients(covariance.unknowns, Eigen::all) * std::sqrt(count / free);
}

// The variance of a clustered estimate, if the gradients are normal, is two thirds of the sum of
// their fourth powers, which for a small highlight is that of the few clusters that see it.
void Allow(const Eigen::MatrixXd& gradients, const Linearised& fit, Eigen::MatrixXd& stat) {
  const Eigen::MatrixXd carried = fit.jacobian * fit.inverse;
  Eigen::ArrayXd squares = Eigen::ArrayXd::Zero(carried.rows()), fourths = squares;
  for (Eigen::Index k = 0; k < gradients.cols(); ++k) {
    const Eigen::ArrayXd square = (carried * gradients.col(k)).array().square();
    squares += square;
    fourths += square.square();
  }
  const Eigen::ArrayXd before = stat.diagonal().array().max(1e-300);
  const Eigen::ArrayXd chance =
      (before + kChanceSigmas * (2.0 / 3.0 * fourths).sqrt()).min(kMostChanceInflation * before);
  const Eigen::VectorXd more = (squares > chance).select((squares / before).sqrt(), 1.0).matrix();
  stat = more.asDiagonal() * stat * more.asDiagonal();
}

double Inflation(const Eigen::MatrixXd& gradients, const Linearised& fit) {
  return (gradients.transpose() * fit.inverse).cwiseProduct(gradients.transpose()).sum() /
         (static_cast<double>(gradients.rows()) * fit.covariance.variance);
}

}  // namespace

void AllowForClusters(const ResidualSplits& splits, double views_per_distinct, Linearised& fit,
                      Eigen::MatrixXd& stat) {
  // All together they sum to 0: one freedom less.
  const Eigen::MatrixXd tiles =
      std::sqrt(views_per_distinct) * Corrected(splits.clusters, fit.covariance, 1.0);
  Allow(tiles, fit, stat);
  // Views that repeat are together in a place already.
  if (splits.places.cols() > 0) Allow(Corrected(splits.places, fit.covariance, 1.0), fit, stat);
  fit.tile_inflation = std::max(Inflation(tiles, fit), 1.0);
  fit.variance_inflation = fit.tile_inflation;
  fit.unexplained_view = splits.squares.cols() > 0;
  if (!fit.unexplained_view) return;
  // Of few and large clusters the unknowns have taken a good part of what goes together.
  const Eigen::MatrixXd squares = Corrected(splits.squares, fit.covariance,
                                            static_cast<double>(fit.covariance.unknowns.size()));
  Allow(squares, fit, stat);
  fit.variance_inflation = std::max(fit.variance_inflation, Inflation(squares, fit));
}

}  // namespace turnlight::estimator::uncertainty
