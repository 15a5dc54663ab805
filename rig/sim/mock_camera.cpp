#include "rig/sim/mock_camera.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/format.h"

namespace turnlight::rig::sim {
namespace {

// Renders kept: enough for a retake, a lamp that is off and a few angles.
constexpr std::size_t kCachedRenders = 8;

DeviceTime FromMs(double ms) {
  return DeviceTime(static_cast<std::int64_t>(std::llround(ms * 1e6)));
}

calib::Exposure ToExposure(const CameraSettings& settings) {
  return {settings.exposure_us, settings.gain_db};
}

std::size_t CacheBytes(const SyntheticCamera& camera) {
  return kCachedRenders * sizeof(cv::Vec3f) * static_cast<std::size_t>(camera.width) *
         static_cast<std::size_t>(camera.height);
}

}  // namespace

Result<Studio> BuildStudio(const MockCameraConfig& config) {
  auto studio = BuildStudio(config.scene);
  if (!studio) return studio;
  studio->radiometry.reference_exposure_us = config.reference_exposure_us;
  studio->places = config.geometry;
  studio->prop = config.prop;
  studio->walk = config.walk;
  if (config.scene.motion.kind == MotionKind::kTable)
    studio->rig = GeometryOf(config.scene.motion, config.geometry);
  return studio;
}

MockCamera::MockCamera(MockCameraConfig config, std::shared_ptr<const Studio> studio,
                       std::shared_ptr<MockTurntable> table, std::shared_ptr<FaultScript> faults)
    : config_(std::move(config)),
      studio_(std::move(studio)),
      shutter_(config_, studio_, std::move(table), std::move(faults),
               CacheBytes(config_.scene.camera)) {}

MockCamera::~MockCamera() = default;

Result<std::unique_ptr<MockCamera>> MockCamera::Create(const MockCameraConfig& config,
                                                       std::shared_ptr<MockTurntable> table,
                                                       std::shared_ptr<FaultScript> faults) {
  if (const auto problem = Validate(config)) return InputError(problem->key + ": " + problem->text);
  auto studio = BuildStudio(config);
  if (!studio) return Forward(studio);
  return std::make_unique<MockCamera>(config, std::make_shared<const Studio>(std::move(*studio)),
                                      std::move(table), std::move(faults));
}

Status MockCamera::CheckLink(DeviceTime now) {
  if (now >= unplugged_until_) {
    if (const auto fault = shutter_.Strike(FaultKind::kUnplugged, now)) {
      open_ = false;
      shutter_.Clear();
      unplugged_until_ = now + FromMs(fault->amount);
    }
  }
  if (now < unplugged_until_) return DeviceError(config_.serial + ": unplugged");
  return {};
}

Result<DeviceIdentity> MockCamera::Open(DeviceTime now) {
  if (Status status = CheckLink(now); !status) return Forward(status);
  open_ = true;
  shutter_.TakeControl();
  settings_ = CameraSettings{};
  return DeviceIdentity{"turnlight", "mock camera", config_.serial};
}

Result<CameraSettings> MockCamera::Set(const CameraSettings& settings, DeviceTime now) {
  if (Status status = CheckLink(now); !status) return Forward(status);
  if (!open_) return DeviceError(config_.serial + ": not open");
  if (!shutter_.in_control()) return DeviceError(config_.serial + ": control lost, open it again");
  if (!(settings.exposure_us > 0.0) || !std::isfinite(settings.exposure_us) ||
      !std::isfinite(settings.gain_db))
    return DeviceError(config_.serial + ": exposure " + NumberText(settings.exposure_us) +
                       " us, gain " + NumberText(settings.gain_db) +
                       " dB, allowed are finite numbers and an exposure above 0");
  settings_ = Adjust(settings);
  return settings_;
}

Result<int> MockCamera::Drain(DeviceTime now) {
  if (Status status = CheckLink(now); !status) return Forward(status);
  if (!open_) return DeviceError(config_.serial + ": not open");
  return shutter_.Drain(now);
}

Result<std::uint64_t> MockCamera::Trigger(DeviceTime now) {
  if (Status status = CheckLink(now); !status) return Forward(status);
  if (!open_) return DeviceError(config_.serial + ": not open");
  shutter_.Trigger(settings_, now);
  return shutter_.triggers();
}

Result<std::optional<RawFrame>> MockCamera::Poll(DeviceTime now) {
  if (Status status = CheckLink(now); !status) return Forward(status);
  if (!open_) return DeviceError(config_.serial + ": not open");
  const Shot* next = shutter_.Next();
  if (!next || next->available > now) return std::optional<RawFrame>();
  const Shot shot = shutter_.Take();
  RawFrame frame;
  frame.image = shutter_.Develop(shot, config_.scene.sensor, studio_->radiometry, false);
  if (!shot.complete) frame.image.rowRange(frame.image.rows / 2, frame.image.rows).setTo(0);
  frame.frame_id = shot.id;
  frame.trigger = shot.trigger;
  frame.exposure_begin = shot.begin;
  frame.exposure_end = shot.end;
  frame.actual = shot.actual;
  frame.complete = shot.complete;
  return std::optional<RawFrame>(std::move(frame));
}

estimator::target::Rendering MockCamera::StaticRender(double angle_deg, bool lit) const {
  return RenderView(*studio_, {angle_deg, lit});
}

MockCamera::Deviation MockCamera::DeviationFromStatic(const RawFrame& frame,
                                                      double angle_deg) const {
  const estimator::target::Rendering still = StaticRender(angle_deg);
  const calib::Radiometry& radiometry = studio_->radiometry;
  const calib::Exposure exposure = ToExposure(frame.actual);
  cv::Mat3f above(still.radiance.size()), below(still.radiance.size());
  for (int i = 0; i < static_cast<int>(still.radiance.total()); ++i)
    for (int c = 0; c < 3; ++c) {
      const float radiance = still.radiance(i)[c];
      const auto sigma =
          static_cast<float>(NoiseSigma(config_.scene.sensor, radiometry, exposure, radiance));
      above(i)[c] = radiance + sigma;
      below(i)[c] = radiance - sigma;
    }
  const cv::Mat3f expected = calib::Encode(still.radiance, radiometry, exposure, CV_32F);
  const cv::Mat3f high = calib::Encode(above, radiometry, exposure, CV_32F);
  const cv::Mat3f low = calib::Encode(below, radiometry, exposure, CV_32F);
  cv::Mat3f dn;
  frame.image.convertTo(dn, CV_32F);
  const bool whole_dn = frame.image.depth() != CV_32F;
  const double rounding_variance = whole_dn ? 1.0 / 12.0 : 0.0;
  const double floor_variance = std::pow(1e-6 * (radiometry.white - radiometry.black), 2);
  Deviation deviation;
  double squares = 0.0, on_target = 0.0, beyond = 0.0;
  for (int i = 0; i < static_cast<int>(dn.total()); ++i)
    for (int c = 0; c < 3; ++c) {
      // What the sensor clips is expected clipped.
      double mean = std::min<double>(expected(i)[c], std::ceil(radiometry.SaturationDn()));
      if (whole_dn) mean = std::max(mean, 0.0);
      const double spread = 0.5 * (high(i)[c] - low(i)[c]);
      const double sigmas = std::abs(dn(i)[c] - mean) /
                            std::sqrt(spread * spread + rounding_variance + floor_variance);
      deviation.max_sigmas = std::max(deviation.max_sigmas, sigmas);
      beyond += sigmas > 5.0;
      if (!(still.coverage(i) > 0.0f)) continue;
      squares += sigmas * sigmas;
      ++on_target;
    }
  deviation.share_beyond_5 = beyond / (3.0 * static_cast<double>(dn.total()));
  if (on_target > 0.0) deviation.rms_sigmas = std::sqrt(squares / on_target);
  return deviation;
}

}  // namespace turnlight::rig::sim
