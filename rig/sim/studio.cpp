#include "rig/sim/studio.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "base/angles.h"
#include "base/parallel.h"
#include "rig/sim/mirror_ball.h"
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

// The axis frame, turned as the table is; of an orbit W.
calib::Pose AxisAt(const calib::RigGeometry& rig, double angle_deg) {
  const auto* table = std::get_if<calib::TurntableGeometry>(&rig);
  if (!table) return {};
  calib::TurntableGeometry axis = *table;
  axis.X_AT = {};
  return calib::PosesAt(axis, angle_deg).X_WT;
}

calib::TargetShape MakeTarget(const SyntheticConfig& config) {
  if (const auto* sphere = std::get_if<calib::SphereShape>(&config.target)) return *sphere;
  if (const auto* plane = std::get_if<calib::PlaneShape>(&config.target)) return *plane;
  return MakeBlob(std::get<Blob>(config.target), config.seed);
}

void Shade(const Studio& studio, cv::Mat3f& radiance) {
  for (int i = 0; i < static_cast<int>(studio.shading.total()); ++i)
    radiance(i) *= studio.shading(i);
}

cv::Mat3f RenderBall(const Studio& studio, const BallOnTable& prop, const calib::Pose& X_WC,
                     const calib::Pose& X_WA) {
  MirrorRoom room;
  double strongest = 0.0;
  for (const estimator::model::Light& light : studio.scene.lights)
    strongest = std::max(strongest, light.intensity);
  for (const estimator::model::Light& light : studio.scene.lights)
    room.lamps.push_back({light.direction, light.inverse_distance, DegToRad(prop.lamp_radius_deg),
                          prop.lamp_radiance * light.intensity / strongest});
  room.ceiling = prop.ceiling;
  room.floor = prop.floor;
  room.background = prop.background;
  const cv::Mat1f grey =
      RenderMirrorBall({X_WA * prop.offset, prop.radius, prop.reflectance, prop.diffuse}, room,
                       studio.rays, X_WC, prop.blur_px);
  cv::Mat3f picture;
  cv::merge(std::vector<cv::Mat>(3, grey), picture);
  return picture;
}

// Of what is no target.
cv::Mat3f RenderProp(const Studio& studio, const calib::RigPoses& poses, double angle_deg,
                     std::uint64_t picture) {
  if (const auto* held = std::get_if<HandheldBoard>(&*studio.prop))
    return RenderBoard(held->board, held->look, PoseOf(*held, studio.camera, picture),
                       studio.camera);
  if (const auto* board = std::get_if<TableBoard>(&*studio.prop)) {
    const calib::Pose X_WA = AxisAt(studio.rig, angle_deg);
    return RenderBoard(board->board, board->look, poses.X_WC.Inverse() * X_WA * PoseOf(*board),
                       studio.camera);
  }
  if (const auto* ball = std::get_if<BallOnTable>(&*studio.prop))
    return RenderBall(studio, *ball, poses.X_WC, AxisAt(studio.rig, angle_deg));
  const Eigen::Vector3f level = std::get<EvenField>(*studio.prop).radiance.cast<float>();
  return cv::Mat3f(studio.camera.height(), studio.camera.width(),
                   cv::Vec3f(level.x(), level.y(), level.z()));
}

// The target before its board. It casts no shadow on it.
estimator::target::Rendering RenderWalk(const Studio& studio, const View& view) {
  const Walk& walk = *studio.walk;
  const calib::RigPoses poses =
      PosesOf(walk, std::get<calib::OrbitGeometry>(studio.rig), view.angle_deg);
  estimator::target::Rendering rendering = RenderPlacement(studio, poses, view.lit);
  cv::Mat3f board = RenderBoard(walk.board, walk.look,
                                poses.X_WC.Inverse() * PoseInMiddle(walk.board), studio.camera);
  Shade(studio, board);
  for (int i = 0; i < static_cast<int>(board.total()); ++i)
    rendering.radiance(i) += (1.0f - rendering.coverage(i)) * board(i);
  return rendering;
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

estimator::target::Rendering RenderScene(const Studio& studio, const estimator::model::Scene& scene,
                                         const calib::RigPoses& placement) {
  estimator::target::Rendering rendering =
      estimator::target::Render(scene, studio.geometry, studio.rays, placement.X_WC, placement.X_WT,
                                {.samples_per_side = studio.samples_per_side});
  Shade(studio, rendering.radiance);
  return rendering;
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
                config.samples_per_side,
                GeometryOf(config.motion),
                {},
                config.seed,
                {},
                {}};
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
  return RenderScene(studio, lit ? studio.scene : dark, placement);
}

estimator::target::Rendering RenderKeyframe(const Studio& studio, const calib::RigPoses& placement,
                                            std::size_t keyframe) {
  return RenderScene(studio, estimator::model::AtKeyframe(studio.scene, keyframe), placement);
}

bool IsHandheld(const Studio& studio) {
  return studio.prop && std::holds_alternative<HandheldBoard>(*studio.prop);
}

estimator::target::Rendering RenderView(const Studio& studio, const View& view) {
  if (studio.walk) return RenderWalk(studio, view);
  const double angle_deg =
      view.angle_deg + AngleNoiseDeg(studio.places, studio.seed, view.angle_deg);
  const calib::RigPoses poses = calib::PosesAt(studio.rig, angle_deg);
  if (!studio.prop) return RenderPlacement(studio, poses, view.lit);
  if (std::holds_alternative<LampOff>(*studio.prop)) return RenderPlacement(studio, poses, false);
  estimator::target::Rendering rendering;
  rendering.radiance = RenderProp(studio, poses, angle_deg, view.picture);
  Shade(studio, rendering.radiance);
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
