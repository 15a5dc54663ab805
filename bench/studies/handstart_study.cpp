#include <Eigen/Geometry>
#include <numbers>

#include "base/angles.h"
#include "base/format.h"
#include "base/random.h"
#include "bench/studies/random_scene.h"
#include "bench/studies/studies.h"
#include "bench/studies/take.h"

namespace turnlight::studies {
namespace {

constexpr std::uint64_t kHandStream = std::uint64_t{1} << 51;
constexpr double kLeastDeg = 10.0;
constexpr double kMostDeg = 70.0;

estimator::model::InitialGuess GuessByHand(const std::vector<rig::sim::LightSpec>& lights,
                                           std::uint64_t number) {
  const RandomStream random(number, kHandStream);
  estimator::model::InitialGuess guess;
  for (std::size_t l = 0; l < lights.size(); ++l) {
    const Eigen::Vector3d direction = lights[l].direction.normalized();
    const double off = DegToRad(random.Uniform(2 * l, kLeastDeg, kMostDeg));
    const double about = random.Uniform(2 * l + 1, 0.0, 2.0 * std::numbers::pi);
    const Eigen::Vector3d axis = Eigen::AngleAxisd(about, direction) * direction.unitOrthogonal();
    estimator::model::Light light;
    light.direction = Eigen::AngleAxisd(off, axis) * direction;
    guess.lights.push_back(light);
  }
  return guess;
}

Json StartByHand(int scene) {
  const auto number = static_cast<std::uint64_t>(scene);
  const auto config = RandomScene(number);
  if (!config) return Json{{"left_out", config.error().text}};
  estimator::EstimateOptions options;
  options.initial = GuessByHand(std::get<std::vector<rig::sim::LightSpec>>(config->lights), number);
  return TakeAndScore(*config, options);
}

}  // namespace

std::vector<Job> HandStartJobs(Range scenes) {
  std::vector<Job> jobs;
  for (int i = scenes.begin; i < scenes.end; ++i) {
    jobs.push_back({Format("handstart/%04d", i), [i] { return StartByHand(i); }});
  }
  return jobs;
}

}  // namespace turnlight::studies
