#include "rig/sim/shutter.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "base/random.h"

namespace turnlight::rig::sim {
namespace {

constexpr double kMinExposureUs = 10.0;
constexpr double kMaxExposureUs = 1e7;
constexpr double kMaxGainDb = 24.0;
constexpr std::uint64_t kMaxFrameId = 65535;

DeviceTime FromMs(double ms) {
  return DeviceTime(static_cast<std::int64_t>(std::llround(ms * 1e6)));
}

DeviceTime ExposureTime(const CameraSettings& settings) {
  return DeviceTime(static_cast<std::int64_t>(std::llround(settings.exposure_us * 1e3)));
}

// The finaliser of splitmix64: every bit of the input reaches every bit of the output.
std::uint64_t Mix(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15u;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return x ^ (x >> 31);
}

RandomStream NoiseStream(std::uint64_t seed, double commanded_deg, const CameraSettings& set,
                         std::uint64_t picture) {
  std::uint64_t key = picture;
  for (const double part : {commanded_deg * 1e6, set.exposure_us * 1e3, set.gain_db * 1e3})
    key = Mix(key ^ static_cast<std::uint64_t>(std::llround(part)));
  return RandomStream(seed, key);
}

cv::Mat1f MeanOfChannels(const cv::Mat3f& colour) {
  cv::Mat1f grey(colour.size());
  for (int row = 0; row < colour.rows; ++row)
    for (int column = 0; column < colour.cols; ++column) {
      const cv::Vec3f& pixel = colour(row, column);
      grey(row, column) = (pixel[0] + pixel[1] + pixel[2]) / 3.0f;
    }
  return grey;
}

}  // namespace

CameraSettings Adjust(const CameraSettings& settings) {
  CameraSettings adjusted;
  adjusted.exposure_us =
      std::round(std::clamp(settings.exposure_us, kMinExposureUs, kMaxExposureUs));
  adjusted.gain_db = std::round(std::clamp(settings.gain_db, 0.0, kMaxGainDb) * 10.0) / 10.0;
  return adjusted;
}

Shutter::Shutter(MockCameraConfig config, std::shared_ptr<const Studio> studio,
                 std::shared_ptr<MockTurntable> table, std::shared_ptr<FaultScript> faults,
                 std::size_t cache_bytes)
    : config_(std::move(config)),
      studio_(std::move(studio)),
      table_(std::move(table)),
      faults_(std::move(faults)),
      cache_(studio_, cache_bytes),
      next_id_(static_cast<std::uint64_t>(config_.first_frame_id)) {}

std::optional<FaultEntry> Shutter::Strike(FaultKind kind, DeviceTime now) {
  if (!faults_) return std::nullopt;
  return faults_->Strike(kind, FaultDevice::kCamera, table_->CommandedAngleDeg(now), now);
}

Shot Shutter::MakeShot(const CameraSettings& settings, DeviceTime begin) {
  Shot shot;
  shot.set = shot.actual = settings;
  shot.begin = begin;
  shot.end = begin + ExposureTime(settings);
  shot.trigger = config_.reports_trigger ? triggers_ : 0;
  shot.picture = triggers_ - 1;
  shot.id = next_id_;
  next_id_ = next_id_ == kMaxFrameId ? 1 : next_id_ + 1;
  return shot;
}

void Shutter::Enqueue(Shot shot) {
  shot.available = shot.end + FromMs(config_.readout_ms);
  if (!queue_.empty()) shot.available = std::max(shot.available, queue_.back().available);
  queue_.push_back(shot);
}

// What changes the picture itself.
void Shutter::StrikeShot(Shot& shot, DeviceTime now) {
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

void Shutter::Trigger(const CameraSettings& settings, DeviceTime now) {
  ++triggers_;
  const DeviceTime begin = now + FromMs(config_.trigger_latency_ms);
  if (Strike(FaultKind::kControlLost, now)) in_control_ = false;
  if (!in_control_ || begin < closed_ || Strike(FaultKind::kTriggerIgnored, now)) return;
  std::optional<Shot> before;
  if (const auto stale = Strike(FaultKind::kStaleFrame, now)) {
    before = MakeShot(settings, begin - FromMs(stale->amount) - ExposureTime(settings));
    before->trigger = config_.reports_trigger ? triggers_ - 1 : 0;
  } else if (last_taken_ && Strike(FaultKind::kDuplicateFrame, now)) {
    before = last_taken_;
  }
  Shot shot = MakeShot(settings, begin);
  StrikeShot(shot, now);
  closed_ = shot.end;
  if (before) {
    Enqueue(*before);
    queue_.back().available =
        std::max(queue_.back().available, shot.end + FromMs(config_.readout_ms));
  }
  if (!Strike(FaultKind::kDroppedFrame, now)) Enqueue(shot);
  if (Strike(FaultKind::kUntriggeredFrame, now)) {
    Shot extra = MakeShot(settings, shot.end);
    extra.trigger = 0;
    closed_ = extra.end;
    Enqueue(extra);
  }
}

Shot Shutter::Take() {
  last_taken_ = queue_.front();
  queue_.pop_front();
  return *last_taken_;
}

int Shutter::Drain(DeviceTime now) {
  int drained = 0;
  for (; !queue_.empty() && queue_.front().available <= now; ++drained) queue_.pop_front();
  return drained;
}

View Shutter::ViewOf(const Shot& shot, double angle_deg) const {
  if (IsHandheld(*studio_)) return {0.0, true, shot.picture};
  return {angle_deg, shot.lit};
}

double Shutter::AngleDeg(DeviceTime time) const {
  return studio_->walk ? WalkedDeg(*studio_->walk, time) : table_->TrueAngleDeg(time);
}

cv::Mat3f Shutter::Expose(const Shot& shot) {
  const int count = config_.blur_samples;
  std::vector<double> angles_deg;
  for (int i = 0; i < count; ++i)
    angles_deg.push_back(
        AngleDeg(shot.begin + (shot.end - shot.begin) * (2 * i + 1) / (2 * count)));
  double low = AngleDeg(shot.begin), high = low;
  for (const double angle_deg : angles_deg) {
    low = std::min(low, angle_deg);
    high = std::max(high, angle_deg);
  }
  const double last_deg = AngleDeg(shot.end);
  if (std::max(high, last_deg) - std::min(low, last_deg) <= config_.blur_threshold_deg)
    return cache_.Radiance(ViewOf(shot, AngleDeg(shot.begin + (shot.end - shot.begin) / 2)));
  cv::Mat3f sum(studio_->rays.height(), studio_->rays.width(), cv::Vec3f(0, 0, 0));
  for (const double angle_deg : angles_deg)
    sum += RenderView(*studio_, ViewOf(shot, angle_deg)).radiance;
  return sum / count;
}

cv::Mat Shutter::Develop(const Shot& shot, const Sensor& sensor,
                         const calib::Radiometry& radiometry, bool grey) {
  const RandomStream noise = NoiseStream(config_.noise_seed.value_or(config_.scene.seed),
                                         table_->CommandedAngleDeg(shot.begin), shot.set,
                                         studio_->prop || studio_->walk ? shot.picture : 0);
  const cv::Mat3f colour = Expose(shot) * shot.light_factor;
  const cv::Mat radiance = grey ? cv::Mat(MeanOfChannels(colour)) : cv::Mat(colour);
  cv::Mat image = Photograph(sensor, radiometry, {shot.actual.exposure_us, shot.actual.gain_db},
                             noise, radiance);
  if (shot.saturated) image.setTo(cv::Scalar::all(std::ceil(radiometry.SaturationDn())));
  if (shot.black) image.setTo(cv::Scalar::all(radiometry.black));
  return image;
}

}  // namespace turnlight::rig::sim
