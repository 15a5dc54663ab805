#include "rig/sim/studio.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "base/angles.h"
#include "base/parallel.h"
#include "rig/sim/random_scene.h"

namespace turnlight::rig::sim {
namespace {

Result<calib::CameraModel> MakeCamera(const SyntheticCamera& config) {
  const double cx = 0.5 * (config.width - 1);
  const double cy = 0.5 * (config.height - 1);
  if (!config.distortion)
    return calib::CameraModel::Pinhole(config.width, config.height, config.focal_px,
                                       config.focal_px, cx, cy);
  char number[64];
  std::string intrinsics;
  const auto add = [&](double value) {
    std::snprintf(number, sizeof number, "%.17g, ", value);
    intrinsics += number;
  };
  for (const double value : {config.focal_px, config.focal_px, cx, cy}) add(value);
  for (const double value : *config.distortion) add(value);
  return calib::CameraModel::FromString(
      "{'lensmodel': 'LENSMODEL_OPENCV8', 'extrinsics': [0, 0, 0, 0, 0, 0], 'intrinsics': [" +
          intrinsics + "], 'imagersize': [" + std::to_string(config.width) + ", " +
          std::to_string(config.height) + "]}",
      "camera");
}

// Falls with the square of the distance from the picture's centre.
cv::Mat1f ShadingOf(const SyntheticCamera& config) {
  if (config.vignetting == 0.0) return {};
  cv::Mat1f shading(config.height, config.width);
  const double cx = 0.5 * (config.width - 1), cy = 0.5 * (config.height - 1);
  for (int row = 0; row < config.height; ++row)
    for (int column = 0; column < config.width; ++column) {
      const double dx = column - cx, dy = row - cy;
      shading(row, column) =
          static_cast<float>(1.0 - config.vignetting * (dx * dx + dy * dy) / (cx * cx + cy * cy));
    }
  return shading;
}

calib::TargetShape MakeTarget(const SyntheticConfig& config) {
  if (const auto* sphere = std::get_if<calib::SphereShape>(&config.target)) return *sphere;
  if (const auto* plane = std::get_if<calib::PlaneShape>(&config.target)) return *plane;
  return MakeBlob(std::get<Blob>(config.target), config.seed);
}

double GainFactor(const calib::Radiometry& radiometry, const calib::Exposure& exposure) {
  return std::pow(10.0, (exposure.gain_db - radiometry.reference_gain_db.value_or(0.0)) / 20.0);
}

// Of the noise of a signal, the share of white that the light gives in this exposure.
double SignalSigma(const Sensor& sensor, double gain_factor, double signal) {
  const double floor = sensor.noise_relative * gain_factor;
  const double shot_variance = sensor.noise_shot * sensor.noise_shot * gain_factor;
  return std::sqrt(floor * floor + shot_variance * std::max(signal, 0.0));
}

cv::Mat WithNoise(const Sensor& sensor, const calib::Radiometry& radiometry,
                  const calib::Exposure& exposure, const RandomStream& random,
                  const cv::Mat& radiance) {
  if (sensor.noise_relative == 0.0 && sensor.noise_shot == 0.0) return radiance;
  const double exposure_factor = calib::ExposureFactor(radiometry, exposure);
  const double gain_factor = GainFactor(radiometry, exposure);
  cv::Mat noisy(radiance.size(), radiance.type());
  const int values = radiance.cols * radiance.channels();
  ParallelFor(static_cast<std::size_t>(radiance.rows), [&](std::size_t row) {
    const auto* in = radiance.ptr<float>(static_cast<int>(row));
    auto* out = noisy.ptr<float>(static_cast<int>(row));
    for (int i = 0; i < values; ++i) {
      const double signal = in[i] / exposure_factor;
      const double sigma = SignalSigma(sensor, gain_factor, signal);
      const std::uint64_t index = row * static_cast<std::uint64_t>(values) + i;
      out[i] = static_cast<float>((signal + sigma * random.Normal(index)) * exposure_factor);
    }
  });
  return noisy;
}

int CvDepth(SensorDepth depth) {
  return depth == SensorDepth::k8 ? CV_8U : depth == SensorDepth::k16 ? CV_16U : CV_32F;
}

}  // namespace

Result<Studio> BuildStudio(const SyntheticConfig& config) {
  if (const auto problem = Validate(config)) return InputError(problem->key + ": " + problem->text);
  auto camera = MakeCamera(config.camera);
  if (!camera) return Forward(camera);
  auto scene = DrawScene(config);
  if (!scene) return Forward(scene);
  const calib::TargetShape target = MakeTarget(config);
  Studio studio{*camera,
                calib::RayGrid(*camera),
                ShadingOf(config.camera),
                target,
                estimator::target::Geometry(target),
                *scene,
                config.sensor.ToRadiometry(),
                config.samples_per_side};
  studio.radiometry.reference_gain_db = 0.0;
  return studio;
}

calib::RigGeometry GeometryOf(const Motion& motion) {
  calib::Pose X_AT;
  if (motion.tilt_deg != 0.0)
    X_AT = calib::Turn(Eigen::Vector3d::UnitY(), DegToRad(motion.tilt_deg));
  if (motion.kind == MotionKind::kOrbit)
    return calib::OrbitGeometry{motion.elevation_deg, motion.distance, X_AT};
  calib::TurntableGeometry table;
  table.X_WC = calib::LookAtOrigin(0.0, DegToRad(motion.elevation_deg), motion.distance);
  table.X_AT = X_AT;
  return table;
}

calib::RigPoses PlaceAt(const Motion& motion, double angle_deg) {
  return calib::PosesAt(GeometryOf(motion), angle_deg);
}

estimator::target::Rendering RenderPlacement(const Studio& studio, const calib::RigPoses& placement,
                                             bool lit) {
  const estimator::model::Scene dark{{}, studio.scene.reflectance};
  estimator::target::Rendering rendering = estimator::target::Render(
      lit ? studio.scene : dark, studio.geometry, studio.rays, placement.X_WC, placement.X_WT,
      {.samples_per_side = studio.samples_per_side});
  for (int i = 0; i < static_cast<int>(studio.shading.total()); ++i)
    rendering.radiance(i) *= studio.shading(i);
  return rendering;
}

double NoiseSigma(const Sensor& sensor, const calib::Radiometry& radiometry,
                  const calib::Exposure& exposure, double radiance) {
  const double exposure_factor = calib::ExposureFactor(radiometry, exposure);
  return SignalSigma(sensor, GainFactor(radiometry, exposure), radiance / exposure_factor) *
         exposure_factor;
}

cv::Mat Photograph(const Sensor& sensor, const calib::Radiometry& radiometry,
                   const calib::Exposure& exposure, const RandomStream& random,
                   const cv::Mat& radiance) {
  const cv::Mat dn = calib::Encode(WithNoise(sensor, radiometry, exposure, random, radiance),
                                   radiometry, exposure, CvDepth(sensor.depth));
  cv::Mat image;
  cv::min(dn, cv::Scalar::all(std::ceil(radiometry.SaturationDn())), image);
  return image;
}

}  // namespace turnlight::rig::sim
