#include "estimator/initial_values.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "base/angles.h"
#include "estimator/settled_solve.h"

namespace turnlight::estimator {
namespace {

constexpr double kExcessFloor = 5e-4;  // radiance: what footprints and edges leave even when clean
constexpr double kNoiseFloor = 0.005;  // of noise^2: how well it is known
constexpr double kEliminationRatio = 3.0;  // true lights gave 40 and more
constexpr double kHardlyMissed = 1.2;
constexpr double kMergeLimitDeg = 15.0;
constexpr double kNoLobeMergeDeg = 25.0;
constexpr double kNegligibleShare = 0.005;

double ExcessFloor(double noise) {
  return kExcessFloor * kExcessFloor + kNoiseFloor * noise * noise;
}

double ValuesIn(const Observations& pixels) {
  return static_cast<double>(pixels.used) * pixels.channels;
}

double Median(std::vector<float>& values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return static_cast<double>(*middle);
}

std::vector<float> Values(const Observations& all, int channel) {
  std::vector<float> values;
  values.reserve(all.used);
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all.pixel[i] != Observations::kNoPixel) values.push_back(all.radiance[channel][i]);
  return values;
}

// What a fit is for: to be compared with others, which differ by factors, or to be gone on from.
constexpr double kToCompare = 2e-4, kToKeep = 1e-6;  // tolerance

Solution SolveStart(const Sample& sample, const Candidate& start, int iterations,
                    bool free_geometry, double tolerance) {
  SolveOptions options;
  options.max_iterations = iterations;
  options.function_tolerance = tolerance;
  options.gauge = Gauge::kDiffuse;
  options.free_directions = free_geometry;
  const bool distant = sample.choice.near == false;
  if (!free_geometry || distant) options.fixed_distance.assign(start.scene.lights.size(), true);
  Scene scene = start.scene;
  if (distant)
    for (Light& light : scene.lights) light.inverse_distance = 0.0;
  return SolveSettled(sample.pixels, scene, options, 1, start.shadows);
}

// Two lights as one: intensities add, the rest is their weighted mean.
Light Merged(const Light& a, const Light& b) {
  const double sum = std::max(a.intensity + b.intensity, 1e-300);
  const double share = a.intensity / sum;
  Light out = a;
  out.direction = (share * a.direction + (1.0 - share) * b.direction).normalized();
  out.inverse_distance = share * a.inverse_distance + (1.0 - share) * b.inverse_distance;
  out.intensity = a.intensity + b.intensity;
  return out;
}

double MergeAngle(const Reflectance& r) {
  const bool lobe = r.specular > 1e-3 * r.diffuse && r.specular_model != SpecularModel::kNone;
  if (!lobe) return DegToRad(kNoLobeMergeDeg);
  return std::min(0.6 * LobeHalfWidth(r.shininess), DegToRad(kMergeLimitDeg));
}

// Merges the closest pair within the angle and removes the negligible, down to `least` lights.
// False if nothing changed.
bool MergeAndPrune(Scene& scene, std::size_t least) {
  std::vector<Light>& lights = scene.lights;
  const std::size_t before = lights.size();
  double total = 0.0;
  for (const Light& light : lights) total += light.intensity;
  std::erase_if(lights, [&](const Light& l) {
    return lights.size() > least && l.intensity < kNegligibleShare * total;
  });
  const double cosine = std::cos(MergeAngle(scene.reflectance));
  for (bool merged = true; merged && lights.size() > least;) {
    merged = false;
    std::size_t a = 0, b = 0;
    double closest = cosine;
    for (std::size_t i = 0; i < lights.size(); ++i)
      for (std::size_t j = i + 1; j < lights.size(); ++j)
        if (lights[i].direction.dot(lights[j].direction) > closest) {
          closest = lights[i].direction.dot(lights[j].direction);
          a = i;
          b = j;
          merged = true;
        }
    if (!merged) break;
    lights[a] = Merged(lights[a], lights[b]);
    lights.erase(lights.begin() + static_cast<std::ptrdiff_t>(b));
  }
  return lights.size() != before;
}

// Appends a solve's costs, as root mean squares, to what went before.
void AppendHistory(const Observations& pixels, const Solution& solution,
                   std::vector<double>& history) {
  const double values = ValuesIn(pixels);
  for (std::size_t i = history.empty() ? 0 : 1; i < solution.cost_history.size(); ++i)
    history.push_back(std::sqrt(2.0 * solution.cost_history[i] / values));
}

Candidate Refit(const Sample& sample, const Candidate& start, int iterations, double noise,
                double tolerance) {
  Solution solution = SolveStart(sample, start, iterations, true, tolerance);
  const double mean_square = 2.0 * solution.equations.cost / ValuesIn(sample.pixels);
  Candidate out{std::move(solution.scene), std::move(solution.evaluate.shadows), mean_square,
                ExcessVariance(mean_square, noise), start.rms_history};
  AppendHistory(sample.pixels, solution, out.rms_history);
  return out;
}

// The best fit without one of the weakest four lights; the first that is hardly missed will do.
Candidate BestWithoutOne(const Sample& sample, const Candidate& full, double noise) {
  std::vector<std::size_t> order(full.scene.lights.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return full.scene.lights[a].intensity < full.scene.lights[b].intensity;
  });
  order.resize(std::min<std::size_t>(order.size(), 4));
  std::optional<Candidate> best;
  for (const std::size_t index : order) {
    Candidate start = full;
    start.scene.lights.erase(start.scene.lights.begin() + static_cast<std::ptrdiff_t>(index));
    Candidate candidate = Refit(sample, start, 20, noise, kToCompare);
    if (!best || candidate.excess < best->excess) best = std::move(candidate);
    if (best->excess <= kHardlyMissed * full.excess) break;
  }
  return std::move(*best);
}

}  // namespace

double EstimateNoise(const Observations& all) {
  std::vector<float> differences;
  for (std::size_t i = 1; i + 1 < all.size(); ++i) {
    if (all.pixel[i] == Observations::kNoPixel || all.pixel[i - 1] + 1 != all.pixel[i] ||
        all.pixel[i] + 1 != all.pixel[i + 1])
      continue;
    for (int c = 0; c < all.channels; ++c)
      differences.push_back(
          std::abs(all.radiance[c][i - 1] - 2.0f * all.radiance[c][i] + all.radiance[c][i + 1]));
  }
  // 0.6745: the median of a unit normal's magnitude; sqrt 6: the filter's own gain.
  return Median(differences) / (0.6745 * std::sqrt(6.0));
}

Eigen::Vector3d MedianColour(const Observations& observations) {
  Eigen::Vector3d colour = Eigen::Vector3d::Zero();
  for (int c = 0; c < observations.channels; ++c) {
    std::vector<float> values = Values(observations, c);
    colour[c] = Median(values);
  }
  if (observations.channels == 1) colour.setConstant(colour[0]);
  return colour;
}

std::vector<Eigen::Vector3d> HemisphereDirections(int count, const Eigen::Vector3d& up) {
  const Eigen::Matrix<double, 3, 2> basis = TangentBasis(up);
  std::vector<Eigen::Vector3d> directions;
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (i + 0.5) / count;
    const double azimuth = 2.0 * std::numbers::pi * i / std::numbers::phi;
    const double r = std::sqrt(1.0 - z * z);
    directions.push_back(z * up +
                         r * (std::cos(azimuth) * basis.col(0) + std::sin(azimuth) * basis.col(1)));
  }
  return directions;
}

Scene StartFromDirections(const Observations& observations,
                          const std::vector<Eigen::Vector3d>& directions) {
  Scene scene;
  const Eigen::Vector3d median = MedianColour(observations).cwiseMax(1e-6);
  Reflectance& r = scene.reflectance;
  r.albedo = median / median.maxCoeff();
  std::vector<float> values = Values(observations, 0);
  const auto low = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 20);
  std::nth_element(values.begin(), low, values.end());
  r.ambient = std::max(static_cast<double>(*low) / r.albedo[0], 0.0);
  r.diffuse = 1.0;
  r.specular = 0.5;
  r.shininess = 20.0;
  for (const Eigen::Vector3d& direction : directions) {
    Light light;
    light.direction = direction;
    light.inverse_distance = 0.05;
    light.intensity = median.maxCoeff() / static_cast<double>(directions.size());
    scene.lights.push_back(light);
  }
  return scene;
}

double ExcessVariance(double mean_square, double noise) {
  return std::max(mean_square - noise * noise, 0.0) + ExcessFloor(noise);
}

bool NothingLeft(double excess, const Sample& sample) {
  const double spread = sample.noise * sample.noise * std::sqrt(2.0 / ValuesIn(sample.pixels));
  return excess <= 1.5 * ExcessFloor(sample.noise) + 4.0 * spread;
}

Candidate FitStart(const Sample& sample, const Scene& start) {
  Candidate best;
  best.scene = start;
  const Solution linear = SolveStart(sample, best, 15, false, kToCompare);
  AppendHistory(sample.pixels, linear, best.rms_history);
  best.scene = linear.scene;
  best.shadows = linear.evaluate.shadows;
  return Refit(sample, best, 40, sample.noise, kToCompare);
}

Candidate FitAndMerge(const Sample& sample, const Scene& start) {
  Candidate best = FitStart(sample, start);
  const auto least = static_cast<std::size_t>(sample.choice.lights.value_or(1));
  for (int round = 0; round < 6; ++round) {
    Candidate merged = best;
    if (!MergeAndPrune(merged.scene, least) || merged.scene.lights.empty()) break;
    best = Refit(sample, merged, 20, sample.noise, kToCompare);
  }
  return best;
}

Candidate FitAndEliminate(const Sample& sample, const Scene& start) {
  return Eliminate(sample, FitAndMerge(sample, start));
}

Candidate Eliminate(const Sample& sample, const Candidate& fitted) {
  Candidate best = Refit(sample, fitted, 40, sample.noise, kToKeep);
  // With lights to spare what is left is noise; a larger estimate of it would hide lights.
  const double least = std::min(sample.noise, std::sqrt(best.mean_square));
  best.excess = ExcessVariance(best.mean_square, least);
  const auto wanted = static_cast<std::size_t>(sample.choice.lights.value_or(0));
  while (best.scene.lights.size() > wanted) {
    Candidate fewer = BestWithoutOne(sample, best, least);
    if (!sample.choice.lights && fewer.excess >= kEliminationRatio * best.excess) break;
    best = std::move(fewer);
  }
  return Refit(sample, best, 40, sample.noise, kToKeep);
}

}  // namespace turnlight::estimator
