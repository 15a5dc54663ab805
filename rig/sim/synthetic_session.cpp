#include "rig/sim/synthetic_session.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "base/file.h"
#include "base/format.h"
#include "base/random.h"
#include "base/sha256.h"
#include "base/statistics.h"
#include "estimator/results/scene_json.h"
#include "estimator/target/renderer.h"
#include "rig/session/image_file.h"
#include "rig/session/session.h"
#include "rig/sim/studio.h"

namespace turnlight::rig::sim {
namespace {

constexpr double kReferenceExposureUs = 1000.0;

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
    const auto rendering = RenderKeyframe(
        studio, PlaceAt(config.motion, i * config.motion.step_deg), static_cast<std::size_t>(i));
    for (int row = 0; row < rendering.radiance.rows; ++row)
      for (int column = 0; column < rendering.radiance.cols; ++column)
        if (rendering.coverage(row, column) > 0.0f)
          values.push_back(BrightestChannel(rendering.radiance(row, column)));
  }
  if (values.empty()) return kReferenceExposureUs;
  const auto clipped =
      static_cast<std::size_t>(*config.sensor.clip_share * static_cast<double>(values.size()));
  const float brightest = OrderStatistic(values, values.size() - 1 - clipped);
  if (!(brightest > 0.0f)) return kReferenceExposureUs;
  return kReferenceExposureUs * SaturatingRadiance(studio.radiometry) / brightest;
}

// A studio, and the one exposure of all frames if the config asks for clipping.
struct Shoot {
  Studio studio;
  calib::Exposure exposure;
};

Result<Shoot> PrepareShoot(const SyntheticConfig& config) {
  auto studio = BuildStudio(config);
  if (!studio) return Forward(studio);
  Shoot shoot{std::move(*studio), {}};
  if (config.sensor.clip_share) {
    shoot.studio.radiometry.reference_exposure_us = kReferenceExposureUs;
    shoot.exposure.exposure_us = ExposureForClipping(config, shoot.studio);
  }
  return shoot;
}

SyntheticFrame MakeFrame(const SyntheticConfig& config, const Shoot& shoot, int index) {
  const double angle_deg = index * config.motion.step_deg;
  const calib::RigPoses placement = PlaceAt(config.motion, angle_deg);
  const estimator::target::Rendering rendering =
      RenderKeyframe(shoot.studio, placement, static_cast<std::size_t>(index));
  const RandomStream random(config.seed, static_cast<std::uint64_t>(index));
  return {Photograph(config.sensor, shoot.studio.radiometry, shoot.exposure, random,
                     rendering.radiance),
          rendering.coverage > 0.0f,
          placement.X_WC,
          placement.X_WT,
          angle_deg,
          shoot.exposure};
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

std::string Percent(double share) { return Format("%.2g %%", 100.0 * share); }

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
  if (Status status =
          WriteFileAtomic(root / "truth.json", estimator::results::TruthToJson(studio.scene));
      !status)
    return status;
  return WriteSession(session, root);
}

}  // namespace

Result<SyntheticSession> SynthesizeInMemory(const SyntheticConfig& config) {
  auto shoot = PrepareShoot(config);
  if (!shoot) return Forward(shoot);
  const Studio& studio = shoot->studio;
  SyntheticSession session{studio.camera, studio.target, studio.radiometry, {}, studio.scene};
  for (int i = 0; i < config.motion.frames; ++i)
    session.frames.push_back(MakeFrame(config, *shoot, i));
  return session;
}

std::vector<estimator::model::Keyframe> ToKeyframes(const SyntheticSession& session) {
  std::vector<estimator::model::Keyframe> keyframes;
  for (const SyntheticFrame& frame : session.frames)
    keyframes.push_back({calib::Linearise(frame.image, session.radiometry, frame.exposure),
                         frame.mask, frame.X_WC, frame.X_WT});
  return keyframes;
}

Result<SyntheticReport> WriteSynthetic(const SyntheticConfig& config,
                                       const std::filesystem::path& root,
                                       const FrameProgress& progress) {
  auto shoot = PrepareShoot(config);
  if (!shoot) return Forward(shoot);
  const Studio& studio = shoot->studio;
  if (Status status = MakeDirectory(root / "frames"); !status) return Forward(status);
  Session session = DescribeSession(config, studio);
  Tally tally;
  for (int i = 0; i < config.motion.frames; ++i) {
    const SyntheticFrame frame = MakeFrame(config, *shoot, i);
    auto record = WriteFrame(config, frame, i, root);
    if (!record) return Forward(record);
    session.frames.push_back(*record);
    const int on_target = cv::countNonZero(frame.mask);
    tally.target_pixels += static_cast<std::size_t>(on_target);
    tally.clipped_pixels += CountClipped(frame, studio.radiometry);
    tally.empty_frames += on_target == 0;
    if (progress && !progress(i + 1, config.motion.frames)) return StoppedReport();
  }
  if (Status status = WriteSurroundings(studio, session, root); !status) return Forward(status);
  return Summarise(config, tally);
}

}  // namespace turnlight::rig::sim
