#include "rig/sim/synthetic_session.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include "base/angles.h"
#include "base/file.h"
#include "base/parallel.h"
#include "base/random.h"
#include "base/sha256.h"
#include "estimator/geometry.h"
#include "estimator/renderer.h"
#include "rig/session/image_file.h"
#include "rig/session/session.h"
#include "rig/sim/random_scene.h"
#include "rig/sim/scene_file.h"

namespace turnlight::rig {
namespace {

using calib::Pose;

constexpr double kReferenceExposureUs = 1000.0;

// Everything that all frames share.
struct Studio {
  calib::CameraModel camera;
  calib::RayGrid rays;
  calib::TargetShape target;
  estimator::Geometry geometry;
  estimator::Scene scene;
  calib::Radiometry radiometry;
  calib::Exposure exposure;
};

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

calib::TargetShape MakeTarget(const SyntheticConfig& config) {
  if (const auto* sphere = std::get_if<calib::SphereShape>(&config.target)) return *sphere;
  if (const auto* plane = std::get_if<calib::PlaneShape>(&config.target)) return *plane;
  return MakeBlob(std::get<Blob>(config.target), config.seed);
}

// A camera at the given azimuth and elevation that looks at W's origin, its x axis level.
Pose LookAtOrigin(double azimuth, double elevation, double distance) {
  const Eigen::Vector3d outward(std::cos(elevation) * std::cos(azimuth),
                                std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
  Pose X_WC;
  X_WC.rotation.col(0) = Eigen::Vector3d(-std::sin(azimuth), std::cos(azimuth), 0.0);
  X_WC.rotation.col(2) = -outward;
  X_WC.rotation.col(1) = X_WC.rotation.col(2).cross(X_WC.rotation.col(0));
  X_WC.translation = distance * outward;
  return X_WC;
}

Pose Turn(const Eigen::Vector3d& axis, double angle) {
  return {Eigen::AngleAxisd(angle, axis).toRotationMatrix(), Eigen::Vector3d::Zero()};
}

SyntheticFrame PlaceFrame(const Motion& motion, int index) {
  SyntheticFrame frame;
  frame.angle_deg = index * motion.step_deg;
  const double angle = DegToRad(frame.angle_deg);
  const bool orbit = motion.kind == MotionKind::kOrbit;
  frame.X_WC = LookAtOrigin(orbit ? angle : 0.0, DegToRad(motion.elevation_deg), motion.distance);
  const Pose tilt =
      motion.tilt_deg == 0.0 ? Pose{} : Turn(Eigen::Vector3d::UnitY(), DegToRad(motion.tilt_deg));
  frame.X_WT = orbit ? tilt : Turn(Eigen::Vector3d::UnitZ(), angle) * tilt;
  return frame;
}

estimator::Rendering RenderFrame(const SyntheticConfig& config, const Studio& studio,
                                 const SyntheticFrame& frame) {
  return estimator::Render(studio.scene, studio.geometry, studio.rays, frame.X_WC, frame.X_WT,
                           {.samples_per_side = config.samples_per_side});
}

// The radiance that reaches saturation at the reference exposure.
double SaturatingRadiance(const calib::Radiometry& radiometry) {
  const cv::Mat1f dn(1, 1, static_cast<float>(radiometry.SaturationDn()));
  return calib::Linearise(dn, radiometry, {}).radiance.at<float>(0, 0);
}

float BrightestChannel(const cv::Vec3f& radiance) {
  return std::max({radiance[0], radiance[1], radiance[2]});
}

// The exposure at which clip_share of the target's pixels are brighter than saturation.
double ExposureForClipping(const SyntheticConfig& config, const Studio& studio) {
  std::vector<float> values;
  for (int i = 0; i < config.motion.frames; ++i) {
    const auto rendering = RenderFrame(config, studio, PlaceFrame(config.motion, i));
    for (int row = 0; row < rendering.radiance.rows; ++row)
      for (int column = 0; column < rendering.radiance.cols; ++column)
        if (rendering.coverage(row, column) > 0.0f)
          values.push_back(BrightestChannel(rendering.radiance(row, column)));
  }
  if (values.empty()) return kReferenceExposureUs;
  const auto clipped =
      static_cast<std::ptrdiff_t>(*config.sensor.clip_share * static_cast<double>(values.size()));
  const auto quantile = values.end() - 1 - clipped;
  std::nth_element(values.begin(), quantile, values.end());
  if (!(*quantile > 0.0f)) return kReferenceExposureUs;
  return kReferenceExposureUs * SaturatingRadiance(studio.radiometry) / *quantile;
}

Result<Studio> BuildStudio(const SyntheticConfig& config) {
  if (const auto problem = Validate(config)) return InputError(problem->key + ": " + problem->text);
  auto camera = MakeCamera(config.camera);
  if (!camera) return Forward(camera);
  auto scene = DrawScene(config);
  if (!scene) return Forward(scene);
  const calib::TargetShape target = MakeTarget(config);
  Studio studio{*camera, calib::RayGrid(*camera),      target, estimator::Geometry(target),
                *scene,  config.sensor.ToRadiometry(), {}};
  studio.radiometry.reference_gain_db = 0.0;
  if (config.sensor.clip_share) {
    studio.radiometry.reference_exposure_us = kReferenceExposureUs;
    studio.exposure.exposure_us = ExposureForClipping(config, studio);
  }
  return studio;
}

void AddNoise(const Sensor& sensor, double exposure_factor, const RandomStream& random,
              cv::Mat3f& radiance) {
  if (sensor.noise_relative == 0.0 && sensor.noise_shot == 0.0) return;
  const double floor_variance = sensor.noise_relative * sensor.noise_relative;
  const double shot_variance = sensor.noise_shot * sensor.noise_shot;
  ParallelFor(static_cast<std::size_t>(radiance.rows), [&](std::size_t row) {
    cv::Vec3f* pixels = radiance[static_cast<int>(row)];
    for (int column = 0; column < radiance.cols; ++column) {
      for (int c = 0; c < 3; ++c) {
        const std::uint64_t index = (row * radiance.cols + column) * 3 + c;
        const double signal = pixels[column][c] / exposure_factor;
        const double sigma = std::sqrt(floor_variance + shot_variance * std::max(signal, 0.0));
        pixels[column][c] =
            static_cast<float>((signal + sigma * random.Normal(index)) * exposure_factor);
      }
    }
  });
}

int CvDepth(SensorDepth depth) {
  return depth == SensorDepth::k8 ? CV_8U : depth == SensorDepth::k16 ? CV_16U : CV_32F;
}

SyntheticFrame MakeFrame(const SyntheticConfig& config, const Studio& studio, int index) {
  SyntheticFrame frame = PlaceFrame(config.motion, index);
  frame.exposure = studio.exposure;
  estimator::Rendering rendering = RenderFrame(config, studio, frame);
  AddNoise(config.sensor, calib::ExposureFactor(studio.radiometry, frame.exposure),
           RandomStream(config.seed, static_cast<std::uint64_t>(index)), rendering.radiance);
  cv::Mat dn = calib::Encode(rendering.radiance, studio.radiometry, frame.exposure,
                             CvDepth(config.sensor.depth));
  cv::min(dn, cv::Scalar::all(std::ceil(studio.radiometry.SaturationDn())), frame.image);
  frame.mask = rendering.coverage > 0.0f;
  return frame;
}

std::size_t CountClipped(const SyntheticFrame& frame, const calib::Radiometry& radiometry) {
  const auto linear = calib::Linearise(frame.image, radiometry, frame.exposure);
  return static_cast<std::size_t>(cv::countNonZero(linear.saturated & frame.mask));
}

const char* Extension(FileFormat format) {
  return format == FileFormat::kPng ? ".png" : format == FileFormat::kTiff ? ".tiff" : ".exr";
}

std::string FrameName(int index, const std::string& ending) {
  char name[32];
  std::snprintf(name, sizeof name, "frames/%03d", index);
  return name + ending;
}

Session DescribeSession(const SyntheticConfig& config, const Studio& studio) {
  Session session;
  session.name = config.name;
  session.length_unit = "mm";
  session.camera_path = "camera.cameramodel";
  session.camera = studio.camera;
  session.radiometry = studio.radiometry;
  if (const auto* sphere = std::get_if<calib::SphereShape>(&studio.target))
    session.target = *sphere;
  else if (const auto* plane = std::get_if<calib::PlaneShape>(&studio.target))
    session.target = *plane;
  else
    session.target = MeshFile{"target.ply"};
  return session;
}

Result<FrameRecord> WriteFrame(const SyntheticConfig& config, const SyntheticFrame& frame,
                               int index, const std::filesystem::path& root) {
  FrameRecord record;
  record.image = FrameName(index, Extension(config.sensor.Format()));
  if (Status status = WriteImage(root / record.image, frame.image); !status) return Forward(status);
  if (config.masks) {
    record.mask = FrameName(index, ".mask.png");
    if (Status status = WriteImage(root / *record.mask, frame.mask); !status)
      return Forward(status);
  }
  auto bytes = ReadFile(root / record.image);
  if (!bytes) return Forward(bytes);
  record.sha256 = Sha256Hex(*bytes);
  record.angle_deg = frame.angle_deg;
  record.exposure = frame.exposure;
  record.X_WC = frame.X_WC;
  record.X_WT = frame.X_WT;
  return record;
}

std::string Percent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g %%", 100.0 * share);
  return text;
}

// What the frames added up to.
struct Tally {
  std::size_t target_pixels = 0;
  std::size_t clipped_pixels = 0;
  int empty_frames = 0;
};

SyntheticReport Summarise(const SyntheticConfig& config, const Tally& tally) {
  SyntheticReport report;
  if (tally.target_pixels > 0)
    report.clipped_share =
        static_cast<double>(tally.clipped_pixels) / static_cast<double>(tally.target_pixels);
  if (!config.sensor.clip_share && tally.clipped_pixels > 0)
    report.remarks.push_back(Percent(report.clipped_share) +
                             " of the target's pixels are clipped; sensor/clip_share: 0 would "
                             "choose an exposure that clips none");
  if (tally.empty_frames > 0)
    report.remarks.push_back(std::to_string(tally.empty_frames) + " of " +
                             std::to_string(config.motion.frames) +
                             " frames show nothing of the target");
  return report;
}

SyntheticReport StoppedReport() {
  SyntheticReport report;
  report.stopped = true;
  return report;
}

Status WriteSurroundings(const Studio& studio, const Session& session,
                         const std::filesystem::path& root) {
  if (const auto* mesh = std::get_if<calib::MeshShape>(&studio.target))
    if (Status status = WriteFileAtomic(root / "target.ply", MeshToPly(*mesh)); !status)
      return status;
  if (Status status = WriteFileAtomic(root / "truth.json", TruthToJson(studio.scene)); !status)
    return status;
  return WriteSession(session, root);
}

}  // namespace

Result<SyntheticSession> SynthesizeInMemory(const SyntheticConfig& config) {
  auto studio = BuildStudio(config);
  if (!studio) return Forward(studio);
  SyntheticSession session{studio->camera, studio->target, studio->radiometry, {}, studio->scene};
  for (int i = 0; i < config.motion.frames; ++i)
    session.frames.push_back(MakeFrame(config, *studio, i));
  return session;
}

std::vector<estimator::Keyframe> ToKeyframes(const SyntheticSession& session) {
  std::vector<estimator::Keyframe> keyframes;
  for (const SyntheticFrame& frame : session.frames)
    keyframes.push_back({calib::Linearise(frame.image, session.radiometry, frame.exposure),
                         frame.mask, frame.X_WC, frame.X_WT});
  return keyframes;
}

Result<SyntheticReport> WriteSynthetic(const SyntheticConfig& config,
                                       const std::filesystem::path& root,
                                       const FrameProgress& progress) {
  auto studio = BuildStudio(config);
  if (!studio) return Forward(studio);
  if (Status status = MakeDirectory(root / "frames"); !status) return Forward(status);
  Session session = DescribeSession(config, *studio);
  Tally tally;
  for (int i = 0; i < config.motion.frames; ++i) {
    const SyntheticFrame frame = MakeFrame(config, *studio, i);
    auto record = WriteFrame(config, frame, i, root);
    if (!record) return Forward(record);
    session.frames.push_back(*record);
    const int on_target = cv::countNonZero(frame.mask);
    tally.target_pixels += static_cast<std::size_t>(on_target);
    tally.clipped_pixels += CountClipped(frame, studio->radiometry);
    tally.empty_frames += on_target == 0;
    if (progress && !progress(i + 1, config.motion.frames)) return StoppedReport();
  }
  if (Status status = WriteSurroundings(*studio, session, root); !status) return Forward(status);
  return Summarise(config, tally);
}

}  // namespace turnlight::rig
