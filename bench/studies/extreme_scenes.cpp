#include <cmath>

#include "base/angles.h"
#include "base/format.h"
#include "bench/studies/extreme_cells.h"

namespace turnlight::studies {
namespace {

using rig::sim::LightSpec;
using rig::sim::SyntheticConfig;

using Change = std::function<void(SyntheticConfig&)>;

void Add(std::vector<ExtremeCell>& cells, const std::string& group, const std::string& setting,
         const Change& change) {
  cells.push_back({group, setting, [change] {
                     SyntheticConfig config = PlainConfig();
                     change(config);
                     return rig::sim::SynthesizeInMemory(config);
                   }});
}

void AddValues(std::vector<ExtremeCell>& cells, const std::string& group,
               const std::vector<double>& values, const std::string& unit,
               const std::function<void(SyntheticConfig&, double)>& change) {
  for (const double value : values)
    Add(cells, group, Format("%g", value) + unit,
        [change, value](SyntheticConfig& config) { change(config, value); });
}

std::vector<LightSpec>& Lights(SyntheticConfig& config) {
  return std::get<std::vector<LightSpec>>(config.lights);
}
estimator::model::Reflectance& Material(SyntheticConfig& config) {
  return std::get<estimator::model::Reflectance>(config.reflectance);
}

Eigen::Vector3d Direction(double zenith_deg, double azimuth_deg) {
  const double zenith = DegToRad(zenith_deg), azimuth = DegToRad(azimuth_deg);
  return {std::sin(zenith) * std::cos(azimuth), std::sin(zenith) * std::sin(azimuth),
          std::cos(zenith)};
}

void AddMaterialCells(std::vector<ExtremeCell>& cells) {
  AddValues(cells, "shininess", {0.5, 1, 2, 5, 20, 100, 500, 2000, 1e4, 1e5}, "",
            [](SyntheticConfig& c, double n) { Material(c).lobes[0].shape = n; });
  Add(cells, "material", "k_s = 0",
      [](SyntheticConfig& c) { Material(c).lobes[0].strength = 0.0; });
  Add(cells, "material", "k_d = 0", [](SyntheticConfig& c) { Material(c).diffuse = 0.0; });
  Add(cells, "material", "k_a = 0", [](SyntheticConfig& c) { Material(c).ambient = 0.0; });
  Add(cells, "material", "ambient only", [](SyntheticConfig& c) {
    Material(c).diffuse = Material(c).lobes[0].strength = 0.0;
    Material(c).ambient = 0.6;
  });
  AddValues(cells, "Oren-Nayar", {10, 30, 60, 90}, " deg", [](SyntheticConfig& c, double sigma) {
    Material(c).diffuse_model = estimator::model::DiffuseModel::kOrenNayar;
    Material(c).roughness = DegToRad(sigma);
  });
}

void AddLightCells(std::vector<ExtremeCell>& cells) {
  // The strength falls with the square of the distance to the surface: exposed for the near side.
  AddValues(cells, "light distance", {1.05, 1.2, 1.5, 2, 3, 10, 30, 100, 1000, 1e4, 1e6, 1e7},
            " radii", [](SyntheticConfig& c, double radii) {
              Lights(c)[0].distance = 50.0 * radii;
              c.sensor.clip_share = 0.0;
            });
  Add(cells, "light distance", "1e9 radii", [](SyntheticConfig& c) {
    c.target = calib::SphereShape{0.5};
    c.motion.distance = 4.2;
    Lights(c)[0].distance = 5e8;
    Lights(c)[1].distance = 9.0;
  });
  AddValues(
      cells, "two lights apart", {0, 0.1, 1, 3, 10, 20, 180}, " deg",
      [](SyntheticConfig& c, double apart) {
        Lights(c)[0] = {Direction(40.0, 0.0), std::nullopt, 0.5, Eigen::Vector3d::Ones()};
        Lights(c)[1] = {Direction(40.0 + apart, 0.0), std::nullopt, 0.4, Eigen::Vector3d::Ones()};
        c.sensor.clip_share = 0.0;
      });
  AddValues(
      cells, "zenith of a light", {85, 100, 120, 150, 180}, " deg",
      [](SyntheticConfig& c, double zenith) { Lights(c)[0].direction = Direction(zenith, 20.0); });
  AddValues(cells, "second light's share", {0.3, 0.1, 0.03, 0.01, 0.003, 0.001}, "",
            [](SyntheticConfig& c, double share) {
              Lights(c)[1].intensity = share * Lights(c)[0].intensity;
            });
  AddValues(cells, "intensity, exposed for it", {1e-6, 1e-3, 1e3, 1e6}, "",
            [](SyntheticConfig& c, double factor) {
              for (LightSpec& light : Lights(c)) light.intensity *= factor;
              Material(c).ambient *= factor;
              c.sensor.clip_share = 0.0;
            });
  AddValues(cells, "intensity, float pictures", {1e-6, 1e-3, 1e3, 1e6}, "",
            [](SyntheticConfig& c, double factor) {
              for (LightSpec& light : Lights(c))
                light.intensity = std::min(1e6, light.intensity * factor);
              Material(c).ambient *= factor;
              c.sensor = {};
              c.sensor.depth = rig::sim::SensorDepth::kFloat;
              c.sensor.saturation = 1e9;
            });
}

void AddViewCells(std::vector<ExtremeCell>& cells) {
  AddValues(cells, "views", {1, 2, 3, 360}, "", [](SyntheticConfig& c, double views) {
    c.motion.frames = static_cast<int>(views);
    c.motion.step_deg = 360.0 / views;
  });
  Add(cells, "views", "1, no noise", [](SyntheticConfig& c) {
    c.motion.frames = 1;
    c.sensor.noise_relative = 0.0;
  });
  Add(cells, "views", "36 that differ by noise only", [](SyntheticConfig& c) {
    c.motion.kind = rig::sim::MotionKind::kTable;
    c.motion.frames = 36;
    c.motion.step_deg = 10.0;
  });
  Add(cells, "views", "36 identical, no noise", [](SyntheticConfig& c) {
    c.motion.kind = rig::sim::MotionKind::kTable;
    c.motion.frames = 36;
    c.motion.step_deg = 10.0;
    c.sensor.noise_relative = 0.0;
  });
  AddValues(cells, "radius", {1e-5, 1e-3, 1, 5e4, 5e7}, " units", [](SyntheticConfig& c, double r) {
    const double scale = r / 50.0;
    c.target = calib::SphereShape{r};
    c.motion.distance *= scale;
    for (LightSpec& light : Lights(c)) *light.distance *= scale;
  });
  AddValues(cells, "picture width", {8, 16, 32, 64, 640}, " px",
            [](SyntheticConfig& c, double width) {
              c.camera.focal_px *= width / c.camera.width;
              c.camera.height = std::max(8, static_cast<int>(0.75 * width));
              c.camera.width = static_cast<int>(width);
            });
  Add(cells, "picture width", "5164 px (20 Mpx), one view", [](SyntheticConfig& c) {
    c.camera.focal_px *= 5164.0 / c.camera.width;
    c.camera.width = 5164;
    c.camera.height = 3873;
    c.motion.frames = 1;
    c.samples_per_side = 1;
  });
}

void AddSensorCells(std::vector<ExtremeCell>& cells) {
  AddValues(cells, "noise", {0, 0.001, 0.01, 0.03, 0.1, 0.3, 0.5}, " of white",
            [](SyntheticConfig& c, double noise) { c.sensor.noise_relative = noise; });
  AddValues(cells, "noise without a black level", {0.001, 0.01, 0.03, 0.1}, " of white",
            [](SyntheticConfig& c, double noise) {
              c.sensor.black = 0.0;
              c.sensor.noise_relative = noise;
            });
  AddValues(cells, "clipped share of the target", {0, 0.1, 0.3, 0.5, 0.7, 0.9}, "",
            [](SyntheticConfig& c, double share) { c.sensor.clip_share = share; });
  for (const double bits : {8.0, 10.0, 12.0, 16.0})
    for (const bool noisy : {false, true})
      Add(cells, "bits", Format("%g", bits) + (noisy ? ", noise 0.2 %" : ", no noise"),
          [bits, noisy](SyntheticConfig& c) {
            c.sensor.depth = bits == 8 ? rig::sim::SensorDepth::k8 : rig::sim::SensorDepth::k16;
            c.sensor.white = std::exp2(bits) - 1.0;
            c.sensor.black = std::exp2(bits - 4.0);
            c.sensor.noise_relative = noisy ? 0.002 : 0.0;
          });
  Add(cells, "bits", "8 sRGB, no noise", [](SyntheticConfig& c) {
    c.sensor.depth = rig::sim::SensorDepth::k8;
    c.sensor.encoding = calib::Encoding::kSrgb;
    c.sensor.black = 0.0;
    c.sensor.noise_relative = 0.0;
  });
  Add(cells, "bits", "float, no noise", [](SyntheticConfig& c) {
    c.sensor = {};
    c.sensor.depth = rig::sim::SensorDepth::kFloat;
  });
}

}  // namespace

rig::sim::SyntheticConfig PlainConfig() {
  SyntheticConfig config;
  config.motion.frames = 8;
  config.motion.step_deg = 45.0;
  config.camera = {160, 120, 380.0, std::nullopt};
  config.lights =
      std::vector<LightSpec>{{Direction(35.0, 20.0), 600.0, 0.55, Eigen::Vector3d::Ones()},
                             {Direction(50.0, 95.0), 900.0, 0.4, Eigen::Vector3d::Ones()}};
  estimator::model::Reflectance material;
  material.albedo = {0.8, 0.6, 0.45};
  material.ambient = 0.05;
  material.diffuse = 0.7;
  material.lobes[0].strength = 0.3;
  material.lobes[0].shape = 40.0;
  config.reflectance = material;
  config.sensor.black = 4096.0;
  config.sensor.noise_relative = 0.002;
  return config;
}

void AddSceneCells(std::vector<ExtremeCell>& cells) {
  Add(cells, "plain", "as it is", [](SyntheticConfig&) {});
  AddMaterialCells(cells);
  AddLightCells(cells);
  AddViewCells(cells);
  AddSensorCells(cells);
}

}  // namespace turnlight::studies
