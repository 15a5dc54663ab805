#include "estimator/start/merge_lights.h"

#include <algorithm>
#include <cmath>

#include "base/angles.h"

namespace turnlight::estimator::start {
namespace {

constexpr double kMergeLimitDeg = 15.0;     // of the angle between two lights of any lobe
constexpr double kNoLobeMergeDeg = 25.0;    // where diffuse shading alone tells them apart
constexpr double kNegligibleShare = 0.005;  // of all lights' strength

// Two lights as one: intensities and colours add, the rest is the mean, weighted by strength.
model::Light Merged(const model::Light& a, const model::Light& b) {
  const double of_a = model::Strength(a);
  const double share = of_a / std::max(of_a + model::Strength(b), 1e-300);
  model::Light out = a;
  out.direction = (share * a.direction + (1.0 - share) * b.direction).normalized();
  out.inverse_distance = share * a.inverse_distance + (1.0 - share) * b.inverse_distance;
  out.intensity = a.intensity + b.intensity;
  if (a.color != b.color)
    out.color = (a.intensity * a.color + b.intensity * b.color) / std::max(out.intensity, 1e-300);
  return out;
}

double MergeAngle(const model::Reflectance& r) {
  const bool lobe = r.lobes[0].present() && model::LobePeak(r.lobes[0]) > 1e-3 * r.diffuse;
  if (!lobe) return DegToRad(kNoLobeMergeDeg);
  return std::min(0.6 * model::LobeHalfWidth(r.lobes[0]), DegToRad(kMergeLimitDeg));
}

// Merges the closest pair within the angle and removes the negligible, down to `least` lights.
// False if nothing changed.
bool MergeAndPrune(model::Scene& scene, std::size_t least) {
  std::vector<model::Light>& lights = scene.lights;
  const std::size_t before = lights.size();
  double total = 0.0;
  for (const model::Light& light : lights) total += model::Strength(light);
  while (lights.size() > least) {
    const auto weakest = std::min_element(
        lights.begin(), lights.end(),
        [](const auto& a, const auto& b) { return model::Strength(a) < model::Strength(b); });
    if (!(model::Strength(*weakest) < kNegligibleShare * total)) break;
    lights.erase(weakest);
  }
  const double angle = MergeAngle(scene.reflectance);
  while (MergeClosest(scene, angle, least)) continue;
  return lights.size() != before;
}

}  // namespace

bool MergeClosest(model::Scene& scene, double angle, std::size_t least) {
  std::vector<model::Light>& lights = scene.lights;
  if (lights.size() <= least) return false;
  std::size_t a = 0, b = 0;
  double closest = std::cos(angle);
  for (std::size_t i = 0; i < lights.size(); ++i)
    for (std::size_t j = i + 1; j < lights.size(); ++j)
      if (lights[i].direction.dot(lights[j].direction) > closest) {
        closest = lights[i].direction.dot(lights[j].direction);
        a = i;
        b = j;
      }
  if (a == b) return false;
  lights[a] = Merged(lights[a], lights[b]);
  lights.erase(lights.begin() + static_cast<std::ptrdiff_t>(b));
  return true;
}

Candidate FitAndMerge(const Sample& sample, const model::Scene& start) {
  Candidate best = FitStart(sample, start);
  const auto least = static_cast<std::size_t>(sample.choice.lights.value_or(1));
  for (int round = 0; round < 6; ++round) {
    Candidate merged = best;
    if (!MergeAndPrune(merged.scene, least) || merged.scene.lights.empty()) break;
    best = Refit(sample, merged, 20, sample.noise, kToCompare);
  }
  return best;
}

}  // namespace turnlight::estimator::start
