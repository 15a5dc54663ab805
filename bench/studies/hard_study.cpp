#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/angles.h"
#include "base/format.h"
#include "base/random.h"
#include "bench/studies/random_scene.h"
#include "bench/studies/studies.h"
#include "bench/studies/take.h"
#include "estimator/model/tangent_basis.h"

namespace turnlight::studies {
namespace {

using rig::sim::LightSpec;
using rig::sim::SyntheticConfig;
using rig::sim::SyntheticSession;

constexpr std::uint64_t kHardStream = (std::uint64_t{1} << 53) + 1;
constexpr std::array kHardships{"close", "weak", "noisy", "few-pixels", "misread", "misplaced"};

// A number uniform in its logarithm.
double LogUniform(const RandomStream& random, std::uint64_t draw, double low, double high) {
  return low * std::pow(high / low, random.Uniform(draw));
}

// Beside the first light, by 0.2 to 1.5 half-widths of the lobe; as far away and half as strong or
// more.
LightSpec Beside(const SyntheticConfig& config, const LightSpec& first,
                 const RandomStream& random) {
  const auto& reflectance = std::get<estimator::model::Reflectance>(config.reflectance);
  const double apart =
      random.Uniform(1, 0.2, 1.5) * estimator::model::MirroredHalfWidth(reflectance.lobes[0]);
  const Eigen::Vector3d u = first.direction.normalized();
  const double angle = random.Uniform(2, 0.0, 2.0 * std::numbers::pi);
  const Eigen::Vector3d axis =
      estimator::model::TangentBasis(u) * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  LightSpec light = first;
  light.direction = std::cos(apart) * u + std::sin(apart) * axis;
  light.intensity *= random.Uniform(3, 0.5, 1.0);
  return light;
}

// What is hard about the scene itself.
void MakeHard(const std::string& kind, const RandomStream& random, SyntheticConfig& config) {
  auto& lights = std::get<std::vector<LightSpec>>(config.lights);
  if (kind == "close") lights.push_back(Beside(config, lights.front(), random));
  if (kind == "weak" && lights.size() > 1) {
    double strongest = 0.0;
    for (const LightSpec& light : lights) strongest = std::max(strongest, light.intensity);
    lights.back().intensity = strongest * LogUniform(random, 1, 0.0003, 0.03);
  }
  if (kind == "noisy") config.sensor.noise_relative = LogUniform(random, 1, 0.03, 0.2);
  if (kind == "few-pixels") {
    const double smaller = LogUniform(random, 1, 4.0, 10.0);
    config.camera.width = static_cast<int>(config.camera.width / smaller);
    config.camera.height = static_cast<int>(config.camera.height / smaller);
    config.camera.focal_px /= smaller;
  }
}

// What is said wrongly of its pictures.
void Mislead(const std::string& kind, const RandomStream& random, double radius,
             SyntheticSession& session) {
  if (kind == "misread") {
    const bool srgb = session.radiometry.encoding == calib::Encoding::kSrgb;
    session.radiometry.encoding = calib::Encoding::kGamma;
    session.radiometry.gamma = (srgb ? 2.2 : 1.0) * LogUniform(random, 1, 1.03, 1.3);
  }
  if (kind == "misplaced") {
    const double off = radius * LogUniform(random, 1, 0.003, 0.03);
    for (int axis = 0; axis < 3; ++axis)
      for (rig::sim::SyntheticFrame& frame : session.frames)
        frame.X_WT.translation[axis] += off * random.Normal(2 + static_cast<std::uint64_t>(axis));
  }
}

Json MeasureHard(const std::string& kind, int scene) {
  auto config = RandomScene(static_cast<std::uint64_t>(scene));
  if (!config) return Json{{"left_out", config.error().text}};
  const RandomStream random(static_cast<std::uint64_t>(scene), kHardStream);
  MakeHard(kind, random, *config);
  auto session = rig::sim::SynthesizeInMemory(*config);
  if (!session) return Json{{"left_out", session.error().text}};
  Mislead(kind, random, rig::sim::TargetRadius(config->target), *session);
  Json record = Joined(Describe(*config), EstimateAndScore(*session));
  record["kind"] = kind;
  return record;
}

}  // namespace

std::vector<Job> HardJobs(Range scenes) {
  std::vector<Job> jobs;
  for (int i = scenes.begin; i < scenes.end; ++i) {
    const std::string kind = kHardships[static_cast<std::size_t>(i) % kHardships.size()];
    jobs.push_back(
        {Format("hard/%04d/%s", i, kind.c_str()), [kind, i] { return MeasureHard(kind, i); }});
  }
  return jobs;
}

std::vector<Job> ShiftedJobs(Range scenes) {
  constexpr double kShift = 1e-4;  // target radii
  std::vector<Job> jobs;
  for (int i = scenes.begin; i < scenes.end; ++i)
    jobs.push_back({Format("shifted/%04d", i), [i] {
                      const auto number = static_cast<std::uint64_t>(i);
                      const auto config = RandomScene(number);
                      if (!config) return Json{{"left_out", config.error().text}};
                      auto session = rig::sim::SynthesizeInMemory(*config);
                      if (!session) return Json{{"failed", session.error().text}};
                      const RandomStream random(number, kHardStream);
                      const Eigen::Vector3d way(random.Normal(0), random.Normal(1),
                                                random.Normal(2));
                      const double by = kShift * rig::sim::TargetRadius(config->target);
                      for (rig::sim::SyntheticFrame& frame : session->frames)
                        frame.X_WT.translation += by * way.normalized();
                      return Joined(Describe(*config), EstimateAndScore(*session));
                    }});
  return jobs;
}

}  // namespace turnlight::studies
