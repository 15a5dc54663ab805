#include "estimator/observe/radiance_unit.h"

#include <cmath>

#include "estimator/observe/radiance_statistics.h"

namespace turnlight::estimator::observe {
namespace {

constexpr double kDimmest = 0.02, kBrightest = 50.0;  // of white

}  // namespace

double RadianceUnit(double brightest) {
  const bool unlit = !(brightest > kDarkRadiance);
  return unlit || (brightest > kDimmest && brightest < kBrightest)
             ? 1.0
             : std::exp2(std::round(std::log2(brightest)));
}

void SetRadianceUnit(Observations& observations) {
  if (observations.used == 0) return;
  const double unit = RadianceUnit(BrightestRadiance(observations));
  if (unit == 1.0) return;
  observations.radiance_unit = unit;
  for (auto& channel : observations.radiance)
    for (float& value : channel) value *= static_cast<float>(1.0 / unit);
  for (float& value : observations.variance) value *= static_cast<float>(1.0 / (unit * unit));
}

}  // namespace turnlight::estimator::observe
