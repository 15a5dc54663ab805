#include "rig/sim/mock_camera.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "base/random.h"

namespace turnlight::rig::sim {
namespace {

constexpr double kMinExposureUs = 10.0;
constexpr double kMaxExposureUs = 1e7;
constexpr double kMaxGainDb = 24.0;
constexpr std::uint64_t kMaxFrameId = 65535;
constexpr std::size_t kCachedRenders = 8;

DeviceTime FromMs(double ms) {
  return DeviceTime(static_cast<std::int64_t>(std::llround(ms * 1e6)));
}

DeviceTime ExposureTime(const CameraSettings& settings) {
  return DeviceTime(static_cast<std::int64_t>(std::llround(settings.exposure_us * 1e3)));
}

calib::Exposure ToExposure(const CameraSettings& settings) {
  return {settings.exposure_us, settings.gain_db};
}

// The finaliser of splitmix64: every bit of the input reaches every bit of the output.
std::uint64_t Mix(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15u;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return x ^ (x >> 31);
}

RandomStream NoiseOf(std::uint64_t seed, double commanded_deg, const CameraSettings& set) {
  std::uint64_t key = 0;
  for (const double part : {commanded_deg * 1e6, set.exposure_us * 1e3, set.gain_db * 1e3})
    key = Mix(key ^ static_cast<std::uint64_t>(std::llround(part)));
  return RandomStream(seed, key);
}

}  // namespace

// One opening of the shutter, to be developed when it is polled.
struct MockCamera::Shot {
  DeviceTime begin{}, end{};
  DeviceTime available{};
  CameraSettings set, actual;
  std::uint64_t id = 0;
  std::uint64_t trigger = 0;
  bool complete = true;
  bool lit = true;
  double light_factor = 1.0;
  bool saturated = false;
  bool black = false;
  std::optional<RawFrame> again;  // a frame delivered before; nothing else counts then
};

Result<Studio> BuildStudio(const MockCameraConfig& config) {
  auto studio = BuildStudio(config.scene);
  if (studio) studio->radiometry.reference_exposure_us = config.reference_exposure_us;
  return studio;
}

MockCamera::MockCamera(MockCameraConfig config, std::shared_ptr<const Studio> studio,
                       std::shared_ptr<MockTurntable> table, std::shared_ptr<FaultScript> faults)
    : config_(std::move(config)),
      studio_(std::move(studio)),
      table_(std::move(table)),
      faults_(std::move(faults)),
      next_id_(static_cast<std::uint64_t>(config_.first_frame_id)) {}

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

std::optional<FaultEntry> MockCamera::Strike(FaultKind kind, DeviceTime now) {
  if (!faults_) return std::nullopt;
  return faults_->Strike(kind, FaultDevice::kCamera, table_->CommandedAngleDeg(now), now);
}

Status MockCamera::CheckLink(DeviceTime now) {
  if (now >= unplugged_until_) {
    if (const auto fault = Strike(FaultKind::kUnplugged, now)) {
      open_ = false;
      queue_.clear();
      unplugged_until_ = now + FromMs(fault->amount);
    }
  }
  if (now < unplugged_until_) return DeviceError(config_.serial + ": unplugged");
  return {};
}

Result<DeviceIdentity> MockCamera::Open(DeviceTime now) {
  if (Status status = CheckLink(now); !status) return Forward(status);
  open_ = in_control_ = true;
  settings_ = CameraSettings{};
  return DeviceIdentity{"turnlight", "mock camera", config_.serial};
}

Result<CameraSettings> MockCamera::Set(const CameraSettings& settings, DeviceTime now) {
  if (Status status = CheckLink(now); !status) return Forward(status);
  if (!open_) return DeviceError(config_.serial + ": not open");
  if (!in_control_) return DeviceError(config_.serial + ": control lost, open it again");
  if (!(settings.exposure_us > 0.0) || !std::isfinite(settings.exposure_us) ||
      !std::isfinite(settings.gain_db))
    return DeviceError(config_.serial + ": exposure " + ShowNumber(settings.exposure_us) +
                       " us, gain " + ShowNumber(settings.gain_db) +
                       " dB, allowed are finite numbers and an exposure above 0");
  settings_.exposure_us =
      std::round(std::clamp(settings.exposure_us, kMinExposureUs, kMaxExposureUs));
  settings_.gain_db = std::round(std::clamp(settings.gain_db, 0.0, kMaxGainDb) * 10.0) / 10.0;
  return settings_;
}

Result<int> MockCamera::Drain(DeviceTime now) {
  if (Status status = CheckLink(now); !status) return Forward(status);
  if (!open_) return DeviceError(config_.serial + ": not open");
  const auto still_coming = std::find_if(queue_.begin(), queue_.end(),
                                         [&](const Shot& shot) { return shot.available > now; });
  const auto drained = static_cast<int>(still_coming - queue_.begin());
  queue_.erase(queue_.begin(), still_coming);
  return drained;
}

MockCamera::Shot MockCamera::NextShot(DeviceTime begin) {
  Shot shot;
  shot.set = shot.actual = settings_;
  shot.begin = begin;
  shot.end = begin + ExposureTime(settings_);
  shot.trigger = config_.reports_trigger ? triggers_ : 0;
  shot.id = next_id_;
  next_id_ = next_id_ == kMaxFrameId ? 1 : next_id_ + 1;
  return shot;
}

void MockCamera::Enqueue(Shot shot) {
  shot.available = shot.end + FromMs(config_.readout_ms);
  if (!queue_.empty()) shot.available = std::max(shot.available, queue_.back().available);
  queue_.push_back(std::move(shot));
}

// What changes the picture itself.
void MockCamera::StrikeShot(Shot& shot, DeviceTime now) {
  if (const auto drift = Strike(FaultKind::kExposureDrift, now))
    shot.actual.exposure_us *= 1.0 + drift->amount;
  if (const auto drift = Strike(FaultKind::kGainDrift, now)) shot.actual.gain_db += drift->amount;
  shot.end = shot.begin + ExposureTime(shot.actual);
  if (const auto creep = Strike(FaultKind::kBlurred, now))
    table_->Creep(creep->amount, shot.begin, shot.end - shot.begin);
  if (const auto flicker = Strike(FaultKind::kFlicker, now))
    shot.light_factor = 1.0 + flicker->amount;
  shot.lit = !Strike(FaultKind::kLampOff, now).has_value();
  shot.saturated = Strike(FaultKind::kSaturated, now).has_value();
  shot.black = Strike(FaultKind::kAllBlack, now).has_value();
  shot.complete = !Strike(FaultKind::kIncompleteFrame, now).has_value();
}

Result<std::uint64_t> MockCamera::Trigger(DeviceTime now) {
  if (Status status = CheckLink(now); !status) return Forward(status);
  if (!open_) return DeviceError(config_.serial + ": not open");
  ++triggers_;
  const DeviceTime begin = now + FromMs(config_.trigger_latency_ms);
  if (Strike(FaultKind::kControlLost, now)) in_control_ = false;
  if (!in_control_ || begin < shutter_closed_ || Strike(FaultKind::kTriggerIgnored, now))
    return triggers_;
  const auto stale = Strike(FaultKind::kStaleFrame, now);
  std::optional<Shot> before;
  if (stale) {
    before = NextShot(begin - FromMs(stale->amount) - ExposureTime(settings_));
    before->trigger = config_.reports_trigger ? triggers_ - 1 : 0;
  } else if (last_delivered_ && Strike(FaultKind::kDuplicateFrame, now)) {
    before.emplace();
    before->again = last_delivered_;
  }
  Shot shot = NextShot(begin);
  StrikeShot(shot, now);
  shutter_closed_ = shot.end;
  if (before) {
    Enqueue(*before);
    queue_.back().available =
        std::max(queue_.back().available, shot.end + FromMs(config_.readout_ms));
  }
  if (!Strike(FaultKind::kDroppedFrame, now)) Enqueue(shot);
  if (Strike(FaultKind::kUntriggeredFrame, now)) {
    Shot extra = NextShot(shot.end);
    extra.trigger = 0;
    shutter_closed_ = extra.end;
    Enqueue(std::move(extra));
  }
  return triggers_;
}

Result<std::optional<RawFrame>> MockCamera::Poll(DeviceTime now) {
  if (Status status = CheckLink(now); !status) return Forward(status);
  if (!open_) return DeviceError(config_.serial + ": not open");
  if (queue_.empty() || queue_.front().available > now) return std::optional<RawFrame>();
  const Shot shot = std::move(queue_.front());
  queue_.erase(queue_.begin());
  RawFrame frame = Develop(shot);
  last_delivered_ = frame;
  last_delivered_->image = frame.image.clone();  // what is given away may be changed
  return std::optional<RawFrame>(std::move(frame));
}

cv::Mat3f MockCamera::CachedRender(double angle_deg, bool lit) {
  for (const Render& render : renders_)
    if (render.angle_deg == angle_deg && render.lit == lit) return render.radiance;
  if (renders_.size() >= kCachedRenders) renders_.erase(renders_.begin());
  renders_.push_back({angle_deg, lit, StaticRender(angle_deg, lit).radiance});
  return renders_.back().radiance;
}

cv::Mat3f MockCamera::Expose(const Shot& shot) {
  const int count = config_.blur_samples;
  std::vector<double> angles_deg;
  for (int i = 0; i < count; ++i)
    angles_deg.push_back(
        table_->TrueAngleDeg(shot.begin + (shot.end - shot.begin) * (2 * i + 1) / (2 * count)));
  double low = table_->TrueAngleDeg(shot.begin), high = low;
  for (const double angle_deg : angles_deg) {
    low = std::min(low, angle_deg);
    high = std::max(high, angle_deg);
  }
  const double last_deg = table_->TrueAngleDeg(shot.end);
  if (std::max(high, last_deg) - std::min(low, last_deg) <= config_.blur_threshold_deg)
    return CachedRender(table_->TrueAngleDeg(shot.begin + (shot.end - shot.begin) / 2), shot.lit);
  cv::Mat3f sum(studio_->rays.height(), studio_->rays.width(), cv::Vec3f(0, 0, 0));
  for (const double angle_deg : angles_deg) sum += StaticRender(angle_deg, shot.lit).radiance;
  return sum / count;
}

RawFrame MockCamera::Develop(const Shot& shot) {
  if (shot.again) return *shot.again;
  RawFrame frame;
  frame.frame_id = shot.id;
  frame.trigger = shot.trigger;
  frame.exposure_begin = shot.begin;
  frame.exposure_end = shot.end;
  frame.actual = shot.actual;
  frame.complete = shot.complete;
  const RandomStream noise =
      NoiseOf(config_.scene.seed, table_->CommandedAngleDeg(shot.begin), shot.set);
  const cv::Mat3f radiance = Expose(shot) * shot.light_factor;
  frame.image = Photograph(config_.scene.sensor, studio_->radiometry, ToExposure(shot.actual),
                           noise, radiance);
  if (shot.saturated)
    frame.image.setTo(cv::Scalar::all(std::ceil(studio_->radiometry.SaturationDn())));
  if (shot.black) frame.image.setTo(cv::Scalar::all(studio_->radiometry.black));
  if (!shot.complete) frame.image.rowRange(frame.image.rows / 2, frame.image.rows).setTo(0);
  return frame;
}

estimator::target::Rendering MockCamera::StaticRender(double angle_deg, bool lit) const {
  return RenderPlacement(*studio_, PlaceAt(config_.scene.motion, angle_deg), lit);
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
