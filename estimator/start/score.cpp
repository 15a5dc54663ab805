#include "estimator/start/score.h"

#include <algorithm>
#include <cmath>

namespace turnlight::estimator::start {

double PriceOf(const model::Scene& scene) {
  const model::Reflectance& r = scene.reflectance;
  double price = kLightPrice * static_cast<double>(scene.lights.size());
  if (scene.free_colours) price += kColourPrice;
  if (r.diffuse_model == model::DiffuseModel::kOrenNayar) price += kRoughPrice;
  if (r.diffuse_model == model::DiffuseModel::kCoated) price += kCoatPrice;
  if (r.lobes[0].present() && r.lobes[0].model != model::SpecularModel::kPhong) price += kLobePrice;
  if (r.lobes[1].present()) price += kSecondLobePrice;
  return price;
}

std::size_t BestOf(const model::ModelChoice& choice, const std::vector<Compared>& compared) {
  const auto off = [&](const Compared& c) {
    const auto lights = static_cast<int>(c.scene->lights.size());
    return choice.lights ? std::abs(lights - *choice.lights) : 0;
  };
  const double least =
      std::min_element(compared.begin(), compared.end(), [](const Compared& a, const Compared& b) {
        return a.excess < b.excess;
      })->excess;
  const auto score = [&](const Compared& c) { return c.excess / least + PriceOf(*c.scene); };
  const auto best =
      std::min_element(compared.begin(), compared.end(), [&](const Compared& a, const Compared& b) {
        return off(a) != off(b) ? off(a) < off(b) : score(a) < score(b);
      });
  return static_cast<std::size_t>(best - compared.begin());
}

}  // namespace turnlight::estimator::start
