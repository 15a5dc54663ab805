// What a generated session is to be: the YAML file of `turnlight synthesize`.
//
// Every key is optional and has the default that its member shows; `turnlight config show FILE`
// prints them all. Lengths are in mm. The keys:
//   seed                0..2^53; everything random follows from it
//   name                the session's name
//   target              {shape: sphere, radius} | {shape: plane, size: [w, h], sides: 1|2} |
//                       {shape: blob, radius, depth, segments}   (see rig/sim/blob.h)
//   motion              {kind: orbit|table, frames, step_deg, distance, elevation_deg, tilt_deg}
//   camera              {size: [w, h], focal_px, lens: pinhole|opencv8, distortion: [8 numbers],
//                       vignetting}
//   lights              a list of {direction, distance (null: distant), intensity, color}
//   random_lights       instead of lights: {count, min_separation_deg, zenith_max_deg,
//                       distance: [lo, hi], distant_share, intensity: [lo, hi]}
//   reflectance         as in truth.json (estimator/results/scene_json.h)
//   random_reflectance  instead of reflectance: {model, diffuse_model, and [lo, hi] of albedo,
//                       ambient, diffuse, specular, shininess, roughness_deg}; a model with an
//                       alpha is as wide and as bright as Phong's of that shininess and specular
//   sensor              {bits: 8|16|float, format: png|tiff|exr, encoding: linear|srgb|{gamma: g},
//                       black, white, saturation, noise_relative, noise_shot, clip_share}
//   samples_per_side    1..32, rays per pixel and axis
//   masks               true writes the target's outline beside each picture
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/result.h"
#include "base/strict_object.h"
#include "calib/radiometry.h"
#include "calib/target_shape.h"
#include "estimator/model/scene.h"
#include "rig/sim/blob.h"
#include "rig/sim/config_fields.h"

namespace turnlight::rig::sim {

struct Interval {
  double low = 0.0;
  double high = 0.0;
};

using SyntheticTarget = std::variant<calib::SphereShape, calib::PlaneShape, Blob>;

enum class MotionKind { kOrbit, kTable };

// Frame i looks at W's origin, where the target sits. Orbit: the camera goes round by i * step_deg,
// counter-clockwise seen from +z. Table: the camera stays, the target turns by as much.
struct Motion {
  MotionKind kind = MotionKind::kOrbit;
  int frames = 12;              // 1..10000
  double step_deg = 30.0;       // -360..360
  double distance = 420.0;      // of the camera from W's origin; outside the target
  double elevation_deg = 30.0;  // of the camera above W's xy plane, -90..90
  double tilt_deg = 0.0;        // planes: leans the normal from +z to frame 0's camera, -90..90
};

struct SyntheticCamera {
  int width = 320;          // 8..16384
  int height = 240;         // 8..16384
  double focal_px = 520.0;  // above 0; the principal point is the picture's centre
  std::optional<std::array<double, 8>> distortion;  // given: OPENCV8, else a pinhole
  // Share of the light that the lens loses in the picture's corners, 0..1; it grows with the square
  // of the distance from the centre.
  double vignetting = 0.0;
};

struct LightSpec {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  // any length but 0
  std::optional<double> distance;                        // from W's origin; none: distant
  double intensity = 1.0;                                // irradiance at W's origin, above 0
  Eigen::Vector3d color = Eigen::Vector3d::Ones();
  // A lamp that flickers or drifts: what multiplies its intensity in each frame that is
  // synthesized; empty: constant. A live camera has it constant.
  std::vector<double> factors{};
};

// Directions uniform on the cap around +z, kept apart; distances uniform in their logarithm.
struct RandomLights {
  int count = 2;                     // 1..64
  double min_separation_deg = 25.0;  // 0..180
  double zenith_max_deg = 70.0;      // 0..180
  Interval distance{600.0, 1500.0};  // above the target's radius
  double distant_share = 0.0;        // probability of a light to be distant, 0..1
  Interval intensity{0.5, 1.0};      // above 0
};

// Each value uniform in its interval; shininess uniform in its logarithm. One albedo per channel.
struct RandomReflectance {
  estimator::model::SpecularModel model = estimator::model::SpecularModel::kPhong;
  estimator::model::DiffuseModel diffuse_model = estimator::model::DiffuseModel::kLambert;
  Interval albedo{0.2, 0.8};
  Interval ambient{0.02, 0.12};
  Interval diffuse{0.4, 0.7};
  Interval specular{0.1, 0.4};
  Interval shininess{10.0, 100.0};    // within 0.5..1e5
  Interval roughness_deg{0.0, 30.0};  // 0..90, for oren-nayar
};

enum class SensorDepth { k8, k16, kFloat };
enum class FileFormat { kPng, kTiff, kExr };

// The signal s is the share of white that the light would give, before the encoding. Its noise is
// normal, with variance noise_relative^2 + noise_shot^2 * s. DN above the saturation are clipped to
// it, and so is what leaves the integer range.
struct Sensor {
  SensorDepth depth = SensorDepth::k16;
  std::optional<FileFormat> format;  // default PNG, or OpenEXR for float
  calib::Encoding encoding = calib::Encoding::kLinear;
  double gamma = 2.2;                // above 0, at most 10
  double black = 0.0;                // DN
  std::optional<double> white;       // DN, above black; default 255, 65535 or 1
  std::optional<double> saturation;  // DN, above black; default white
  double noise_relative = 0.0;       // 0..1
  double noise_shot = 0.0;           // 0..1, standard deviation at white from this part alone
  // Given: one exposure for all frames is chosen so that this share of the target's pixels clips
  // (before noise), 0..0.9. Not given: radiance 1 is white and what is brighter clips.
  std::optional<double> clip_share;

  FileFormat Format() const;
  calib::Radiometry ToRadiometry() const;
};

struct SyntheticConfig {
  std::uint64_t seed = 1;
  std::string name = "synthetic";
  SyntheticTarget target = calib::SphereShape{50.0};
  Motion motion;
  SyntheticCamera camera;
  std::variant<std::vector<LightSpec>, RandomLights> lights = RandomLights{};
  std::variant<estimator::model::Reflectance, RandomReflectance> reflectance = RandomReflectance{};
  Sensor sensor;
  int samples_per_side = 5;
  bool masks = false;
};

// Half the extent of the target: of a sphere around W's origin that holds it in every frame.
double TargetRadius(const SyntheticTarget& target);

// Checks every range and everything that must fit together. Gives the first thing that is wrong:
// its key, such as "motion/distance", and the value with what is allowed.
std::optional<ConfigProblem> Validate(const SyntheticConfig& config);

// Reads and validates; messages name file, line and key.
Result<SyntheticConfig> ParseSyntheticConfig(const std::string& text, const std::string& file);
Result<SyntheticConfig> ReadSyntheticConfig(const std::filesystem::path& path);
// The same keys as a part of another config.
Result<SyntheticConfig> ReadSyntheticConfig(StrictObject object);

// All keys with their values, as YAML that reads back to the same config.
std::string ToYaml(const SyntheticConfig& config);

}  // namespace turnlight::rig::sim
