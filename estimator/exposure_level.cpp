#include "estimator/exposure_level.h"

#include <cmath>

namespace turnlight::estimator {
namespace {

constexpr double kDimmest = 0.02, kBrightest = 50.0;  // of white

void Scale(uncertainty::Uncertainty& sigma, double by) {
  sigma.ambient *= by;
  sigma.diffuse *= by;
  for (uncertainty::LobeSigma& lobe : sigma.lobes) lobe.strength *= by;
  sigma.ambient_product *= by;
  for (uncertainty::LightSigma& light : sigma.lights) {
    light.diffuse_product *= by;
    for (double& sigma_of : light.specular_product) sigma_of *= by;
  }
}

}  // namespace

double ExposureLevel(double brightest) {
  return brightest > kDimmest && brightest < kBrightest
             ? 1.0
             : std::exp2(std::round(std::log2(brightest)));
}

void Scale(observe::Observations& observations, double by) {
  for (auto& channel : observations.radiance)
    for (float& value : channel) value *= static_cast<float>(by);
  observations.level *= by;
  for (float& value : observations.variance) value *= static_cast<float>(by * by);
}

void Scale(model::Reflectance& r, double by) {
  r.ambient *= by;
  r.diffuse *= by;
  for (model::Lobe& lobe : r.lobes) lobe.strength *= by;
}

void Scale(Estimate& estimate, double by) {
  Scale(estimate.reflectance, by);
  Scale(estimate.stat, by);
  for (auto* sigma :
       {&estimate.sigma.ambient, &estimate.sigma.diffuse, &estimate.initial_rms, &estimate.rms})
    *sigma *= by;
  for (ReflectanceSigma::OfLobe& lobe : estimate.sigma.lobes) lobe.strength *= by;
  for (auto* colour : {&estimate.ambient_product, &estimate.ambient_product_sigma}) *colour *= by;
  for (LightEstimate& light : estimate.lights) {
    light.diffuse_product *= by;
    light.diffuse_product_sigma *= by;
    for (auto* products : {&light.specular_product, &light.specular_product_sigma})
      for (double& product : *products) product *= by;
  }
  for (uncertainty::BudgetItem& item : estimate.budget) Scale(item.sigma, by);
  for (IterationRecord& record : estimate.history) record.rms *= by;
}

}  // namespace turnlight::estimator
