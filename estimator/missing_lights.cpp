#include "estimator/missing_lights.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/angles.h"
#include "estimator/normal_equations.h"

namespace turnlight::estimator {
namespace {

constexpr int kDirections = 200;  // 14 degrees apart on the sphere
constexpr double kPeakSeparationDeg = 20.0;
constexpr std::size_t kMostPeaks = 8;
constexpr double kLeastGain = 0.05;  // of the best direction's
constexpr int kMostRounds = 5;
constexpr double kWorthGoingOn = 1.2;    // of the excess variance, per round
constexpr double kWorthIt = 3.0;         // of the excess variance, in all
constexpr double kNewDistance = 0.05;    // 1/R
constexpr std::size_t kMostLights = 40;  // more would cost more than they could tell

std::vector<Eigen::Vector3d> SphereDirections(int count) {
  std::vector<Eigen::Vector3d> directions =
      HemisphereDirections(count / 2, Eigen::Vector3d::UnitZ());
  const std::size_t half = directions.size();
  for (std::size_t i = 0; i < half; ++i) directions.emplace_back(-directions[i]);
  return directions;
}

struct Gain {
  Light light;        // with the intensity that helps most
  double gain = 0.0;  // by which the cost falls, to second order, all else held
};

// The directions in batches of as many as a scene holds.
std::vector<Gain> Gains(const Observations& pixels, const Candidate& candidate) {
  const std::vector<Eigen::Vector3d> directions = SphereDirections(kDirections);
  const std::size_t known = candidate.scene.lights.size();
  const std::size_t batch = kMaxLights - known;
  std::vector<Gain> gains;
  for (std::size_t begin = 0; begin < directions.size(); begin += batch) {
    Scene scene = candidate.scene;
    const std::size_t end = std::min(directions.size(), begin + batch);
    for (std::size_t d = begin; d < end; ++d)
      scene.lights.push_back({directions[d], kNewDistance, 0.0, Eigen::Vector3d::Ones()});
    EvaluateOptions options;
    options.samples_per_side = FootprintSamples(pixels, scene.reflectance.shininess);
    options.shadows = CastShadows(pixels, scene, candidate.shadows, 5e-3);
    const NormalEquations equations = Evaluate(pixels, scene, options);
    const Columns columns{pixels.channels, static_cast<int>(scene.lights.size())};
    for (std::size_t l = known; l < scene.lights.size(); ++l) {
      const int column = columns.Intensity(static_cast<int>(l));
      const double slope = equations.gradient[column],
                   curvature = equations.hessian(column, column);
      if (!(slope < 0.0) || !(curvature > 0.0)) continue;
      Gain& gain = gains.emplace_back();
      gain.light = scene.lights[l];
      gain.light.intensity = -slope / curvature;
      gain.gain = 0.5 * slope * slope / curvature;
    }
  }
  std::stable_sort(gains.begin(), gains.end(),
                   [](const Gain& a, const Gain& b) { return a.gain > b.gain; });
  return gains;
}

// The best directions that are well apart.
std::vector<Light> Peaks(const std::vector<Gain>& gains, std::size_t room) {
  const double cosine = std::cos(DegToRad(kPeakSeparationDeg));
  std::vector<Light> peaks;
  for (const Gain& gain : gains) {
    if (peaks.size() == std::min(room, kMostPeaks) || gain.gain < kLeastGain * gains.front().gain)
      break;
    const auto close = [&](const Light& p) {
      return p.direction.dot(gain.light.direction) > cosine;
    };
    if (std::none_of(peaks.begin(), peaks.end(), close)) peaks.push_back(gain.light);
  }
  // Each intensity is what would do alone.
  for (Light& light : peaks) light.intensity /= static_cast<double>(peaks.size());
  return peaks;
}

}  // namespace

std::optional<Light> MostMissingLight(const Observations& pixels, const Scene& scene) {
  EvaluateOptions options;
  options.samples_per_side = FootprintSamples(pixels, scene.reflectance.shininess);
  options.shadows = CastShadows(pixels, scene);
  const auto model = Predict(pixels, scene, options);
  Scene alone = scene;
  alone.reflectance.ambient = 0.0;
  std::optional<Light> best;
  double most = 0.0;
  for (const Eigen::Vector3d& direction : SphereDirections(kDirections)) {
    alone.lights = {{direction, kNewDistance, 1.0, Eigen::Vector3d::Ones()}};
    options.shadows = CastShadows(pixels, alone, options.shadows);
    const auto change = Predict(pixels, alone, options);
    double slope = 0.0, curvature = 0.0;
    for (std::size_t c = 0; c < model.size(); ++c)
      for (std::size_t i = 0; i < pixels.size(); ++i) {
        if (pixels.pixel[i] == Observations::kNoPixel) continue;
        const auto by = static_cast<double>(change[c][i]);
        slope +=
            by * (static_cast<double>(model[c][i]) - static_cast<double>(pixels.radiance[c][i]));
        curvature += by * by;
      }
    if (!(slope < 0.0) || !(slope * slope > most * curvature)) continue;
    most = slope * slope / curvature;
    best = alone.lights.front();
    best->intensity = -slope / curvature;
  }
  return best;
}

Candidate AddMissingLights(const Sample& sample, Candidate candidate) {
  const auto wanted = sample.choice.lights;
  Candidate grown = candidate;
  for (int round = 0; round < kMostRounds; ++round) {
    const std::size_t lights = grown.scene.lights.size();
    const bool enough =
        wanted ? lights >= static_cast<std::size_t>(*wanted) : NothingLeft(grown.excess, sample);
    if (enough || lights >= kMostLights) break;
    Scene start = grown.scene;
    const std::vector<Light> peaks = Peaks(Gains(sample.pixels, grown), kMostLights - lights);
    if (peaks.empty()) break;
    start.lights.insert(start.lights.end(), peaks.begin(), peaks.end());
    Candidate more = FitAndMerge(sample, start);
    if (!wanted && more.excess * kWorthGoingOn > grown.excess) break;
    more.rms_history.insert(more.rms_history.begin(), grown.rms_history.begin(),
                            grown.rms_history.end());
    grown = std::move(more);
  }
  if (grown.scene.lights.size() == candidate.scene.lights.size()) return candidate;
  if (!wanted && grown.excess * kWorthIt > candidate.excess) return candidate;
  // Only from a fit that explains the pictures can it be told which lights are needed.
  grown = Eliminate(sample, grown);
  return !wanted && grown.excess * kWorthIt > candidate.excess ? candidate : grown;
}

}  // namespace turnlight::estimator
