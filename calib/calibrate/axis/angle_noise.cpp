#include "calib/calibrate/axis/angle_noise.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace turnlight::calib::calibrate::axis {
namespace {

// Of variance ratios (rad^2 / px^2) that are looked at, as decimal logarithms: from deviations of
// 1e-4 degrees beside corners of 10 px to one of 60 degrees beside corners of 0.01 px.
constexpr double kLowest = -14.0, kHighest = 4.0, kCoarse = 0.25;
constexpr int kFineSteps = 60;

struct Profile {
  double criterion = 0.0;  // -2 log likelihood, to be minimised
  double corner_variance = 0.0;
};

Profile ProfileAt(const std::vector<ViewSums>& views, double ratio, int freedom,
                  double least_variance) {
  const Eigen::LDLT<Eigen::MatrixXd> normal(MarginalNormal(views, ratio));
  Eigen::VectorXd right = Eigen::VectorXd::Zero(views.front().xy.size());
  double squares = 0.0, logarithms = 0.0;
  for (const ViewSums& view : views) {
    const double share = DeviationShare(view, ratio);
    right += view.xy - share * view.zy * view.xz;
    squares += view.yy - share * view.zy * view.zy;
    if (!view.free_angle) logarithms += std::log1p(ratio * view.zz);
  }
  squares = std::max(squares - right.dot(normal.solve(right)), 0.0);
  Profile profile;
  profile.corner_variance = std::max(squares / freedom, least_variance);
  profile.criterion = freedom * std::log(profile.corner_variance) +
                      squares / profile.corner_variance + logarithms +
                      normal.vectorD().array().abs().log().sum();
  return profile;
}

}  // namespace

double DeviationShare(const ViewSums& view, double variance_ratio) {
  return view.free_angle ? 1.0 / view.zz : variance_ratio / (1.0 + variance_ratio * view.zz);
}

Eigen::MatrixXd MarginalNormal(const std::vector<ViewSums>& views, double variance_ratio) {
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(views.front().xx.rows(), views.front().xx.cols());
  for (const ViewSums& view : views)
    normal += view.xx - DeviationShare(view, variance_ratio) * view.xz * view.xz.transpose();
  return normal;
}

NoiseEstimate EstimateNoise(const std::vector<ViewSums>& views, int angle_parameters,
                            double least_corner) {
  NoiseEstimate noise;
  noise.angle_freedom = -angle_parameters;
  noise.corner_freedom = -static_cast<int>(views.front().xy.size());
  for (const ViewSums& view : views) {
    noise.corner_freedom += view.rows - (view.free_angle ? 1 : 0);
    noise.angle_freedom += view.free_angle ? 0 : 1;
  }
  const int freedom = std::max(noise.corner_freedom, 1);
  const double least = least_corner * least_corner;
  const auto criterion = [&](double exponent) {
    return ProfileAt(views, std::pow(10.0, exponent), freedom, least).criterion;
  };
  double best = kLowest, lowest = criterion(kLowest);
  for (double exponent = kLowest; exponent <= kHighest; exponent += kCoarse) {
    const double value = criterion(exponent);
    if (value < lowest) {
      lowest = value;
      best = exponent;
    }
  }
  double low = best - kCoarse, high = best + kCoarse;
  for (int i = 0; i < kFineSteps; ++i) {
    const double a = low + 0.382 * (high - low), b = low + 0.618 * (high - low);
    (criterion(a) < criterion(b) ? high : low) = criterion(a) < criterion(b) ? b : a;
  }
  const double ratio = std::pow(10.0, 0.5 * (low + high));
  noise.corner = std::sqrt(ProfileAt(views, ratio, freedom, least).corner_variance);
  noise.angle = std::sqrt(ratio) * noise.corner;
  return noise;
}

}  // namespace turnlight::calib::calibrate::axis
