#include <Eigen/Geometry>

#include "base/angles.h"
#include "base/format.h"
#include "base/random.h"
#include "bench/studies/studies.h"
#include "bench/studies/take.h"

namespace turnlight::studies {
namespace {

constexpr std::uint64_t kArrangementStream = std::uint64_t{1} << 50;

std::vector<rig::sim::LightSpec> EightLights(int arrangement, double radius) {
  const RandomStream random(static_cast<std::uint64_t>(arrangement), kArrangementStream);
  const bool first = arrangement == 0;
  std::vector<rig::sim::LightSpec> lights;
  std::uint64_t next = 0;
  const double turn = first ? 0.0 : random.Uniform(next++, 0.0, 360.0);
  for (int i = 0; i < 8; ++i) {
    const bool upper = i < 3;
    const auto jitter = [&] { return first ? 0.0 : random.Uniform(next++, -5.0, 5.0); };
    const double zenith = DegToRad((upper ? 22.0 : 58.0) + jitter());
    const double azimuth =
        DegToRad(turn + (upper ? 20.0 + 120.0 * i : 35.0 + 72.0 * (i - 3)) + jitter());
    rig::sim::LightSpec light;
    light.direction = {std::sin(zenith) * std::cos(azimuth), std::sin(zenith) * std::sin(azimuth),
                       std::cos(zenith)};
    light.distance =
        first ? 5000.0 : radius * std::exp(random.Uniform(next++, std::log(5.0), std::log(40.0)));
    light.intensity = first ? 0.25 : random.Uniform(next++, 0.17, 0.34);
    lights.push_back(light);
  }
  return lights;
}

rig::sim::SyntheticConfig EightConfig(int arrangement, bool mesh, int views, double noise) {
  rig::sim::SyntheticConfig config;
  config.seed = static_cast<std::uint64_t>(arrangement) + 1;
  if (mesh) config.target = rig::sim::Blob{40.0, 0.25, 128};
  config.motion.frames = views;
  config.motion.step_deg = 360.0 / views;
  config.motion.elevation_deg = 40.0;
  config.lights = EightLights(arrangement, rig::sim::TargetRadius(config.target));
  estimator::model::Reflectance material;
  material.albedo = {0.5, 0.45, 0.35};
  material.ambient = 0.1;
  material.diffuse = 0.2;
  material.lobes[0].strength = 0.6;
  material.lobes[0].shape = 80.0;
  config.reflectance = material;
  config.sensor.black = 4096.0;
  config.sensor.noise_relative = noise;
  return config;
}

// The estimate, and beside it the paper's method on the same pictures.
Json WithPaper(const rig::sim::SyntheticConfig& config) {
  const auto session = rig::sim::SynthesizeInMemory(config);
  if (!session) return Json{{"failed", session.error().text}};
  Json record = Joined(Describe(config), EstimateAndScore(*session));
  estimator::baseline::PaperOptions options;
  options.ceiling_distance = 2500.0;  // mm
  options.up = Eigen::Vector3d::UnitZ();
  record["paper"] = EstimateAndScoreByPaper(*session, options);
  return record;
}

}  // namespace

std::vector<Job> EightJobs(Range arrangements) {
  std::vector<Job> jobs;
  for (int i = arrangements.begin; i < arrangements.end; ++i)
    for (const bool mesh : {false, true})
      for (const int views : {20, 10})
        for (const double noise : {0.0, 0.01}) {
          const std::string id =
              Format("eight/%s/%d-views/noise-%g/%03d", mesh ? "lump" : "ball", views, noise, i);
          jobs.push_back({id, [=] { return WithPaper(EightConfig(i, mesh, views, noise)); }});
        }
  return jobs;
}

}  // namespace turnlight::studies
