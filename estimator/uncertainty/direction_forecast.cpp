#include "estimator/uncertainty/direction_forecast.h"

#include <cmath>
#include <limits>

#include "estimator/uncertainty/covariance.h"

namespace turnlight::estimator::uncertainty {
namespace {

// A change of a direction by less than this for a change of an unknown by 1 is none.
constexpr double kNoChange = 1e-6;

bool DependsOn(const DirectionForecast::Light& light, const std::vector<bool>& undetermined) {
  for (std::size_t i = 0; i < undetermined.size(); ++i)
    if (undetermined[i] &&
        light.jacobian.col(static_cast<Eigen::Index>(i)).cwiseAbs().maxCoeff() > kNoChange)
      return true;
  return false;
}

}  // namespace

std::vector<double> ForecastDirections(const DirectionForecast& forecast,
                                       const Eigen::MatrixXd& more) {
  Eigen::MatrixXd hessian = forecast.hessian;
  if (more.size() > 0) hessian += more(forecast.unknowns, forecast.unknowns);
  const Covariance covariance = InvertInformation(hessian, forecast.variance);
  std::vector<double> out;
  for (const DirectionForecast::Light& light : forecast.lights) {
    if (DependsOn(light, covariance.undetermined)) {
      out.push_back(std::numeric_limits<double>::infinity());
      continue;
    }
    const Eigen::Matrix2d stat = light.inflation.asDiagonal() *
                                 (light.jacobian * covariance.matrix * light.jacobian.transpose()) *
                                 light.inflation.asDiagonal();
    out.push_back(LongerHalfAxis(stat + light.floor));
  }
  return out;
}

std::vector<double> FloorOfDirections(const DirectionForecast& forecast) {
  std::vector<double> out;
  for (const DirectionForecast::Light& light : forecast.lights)
    out.push_back(LongerHalfAxis(light.floor));
  return out;
}

}  // namespace turnlight::estimator::uncertainty
