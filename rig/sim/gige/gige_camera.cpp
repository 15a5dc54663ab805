#include "rig/sim/gige/gige_camera.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace turnlight::rig::sim::gige {
namespace {

using std::chrono::hours;
using std::chrono::microseconds;
using std::chrono::milliseconds;

// How often a trigger is looked for, and a client, when there is none.
constexpr auto kPollPeriod = microseconds(500);
constexpr auto kIdlePeriod = milliseconds(5);
// Until it is tried again whether the address is free for a camera that returns.
constexpr auto kReturnPeriod = milliseconds(100);
// A revolution of 36 colour pictures of 1.2 million pixels is 520 MB, of 77 000 pixels 33 MB.
constexpr std::size_t kCacheBytes = std::size_t{640} << 20;
constexpr std::size_t kBacklog = 4;
constexpr int kTemperatureTenths = 415;
constexpr int kFramePeriodUs = 40000;

std::uint64_t NanosecondsSince1970() {
  return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(
                                        std::chrono::system_clock::now().time_since_epoch())
                                        .count());
}

std::uint32_t Rounded(double value) { return static_cast<std::uint32_t>(std::llround(value)); }

bool SameRegisters(const CameraSettings& a, const CameraSettings& b) {
  return Rounded(a.exposure_us) == Rounded(b.exposure_us) &&
         Rounded(a.gain_db * 10.0) == Rounded(b.gain_db * 10.0);
}

}  // namespace

GigeCamera::GigeCamera(CameraConfig config, const SimulatedWorld& world, Clock::time_point origin,
                       AddressLock lock)
    : config_(std::move(config)),
      lock_(std::move(lock)),
      studio_(world.studio),
      table_(world.table),
      origin_(origin),
      shutter_(config_.camera, studio_, table_, world.faults, kCacheBytes) {}

FakeDeviceConfig GigeCamera::AtPowerOn() const {
  const SyntheticConfig& scene = config_.camera.scene;
  const calib::Radiometry radiometry =
      RadiometryOf(studio_->radiometry, scene.sensor, *config_.format);
  return {config_.address,
          config_.camera.serial,
          {scene.camera.width, scene.camera.height},
          config_.format,
          static_cast<int>(radiometry.black),
          config_.packet_loss};
}

Result<std::unique_ptr<GigeCamera>> GigeCamera::Start(const CameraConfig& config,
                                                      const SimulatedWorld& world,
                                                      Clock::time_point origin) {
  auto lock = AddressLock::Take(config.address);
  if (!lock) return Forward(lock);
  std::unique_ptr<GigeCamera> camera(new GigeCamera(config, world, origin, std::move(*lock)));
  auto device = FakeDevice::Start(camera->AtPowerOn());
  if (!device) return Forward(device);
  camera->device_ = std::move(*device);
  camera->SetUp();
  camera->darkroom_ = std::thread([&it = *camera] { it.Develop(); });
  camera->worker_ = std::thread([&it = *camera] { it.Work(); });
  return camera;
}

GigeCamera::~GigeCamera() {
  stopped_ = true;
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  if (worker_.joinable()) worker_.join();
  if (darkroom_.joinable()) darkroom_.join();
}

void GigeCamera::SetUp() {
  WriteSettings(CameraSettings());
  device_->Write(Register::kFramePeriodUs, kFramePeriodUs);
  device_->Write(Register::kTemperatureTenths, kTemperatureTenths);
}

void GigeCamera::Work() {
  while (!stopped_) {
    const DeviceTime now = Now();
    RenderAhead(now);
    if (device_)
      Pass(now);
    else
      PlugIn(now);
    const bool busy = device_ && device_->Read(Register::kControlChannelPrivilege) != 0;
    std::this_thread::sleep_for(busy ? DeviceTime(kPollPeriod) : DeviceTime(kIdlePeriod));
  }
}

void GigeCamera::Pass(DeviceTime now) {
  device_->WriteTimestamp(NanosecondsSince1970());
  if (device_->Read(Register::kControlChannelPrivilege) == 0) return Forget();
  if (const auto fault = shutter_.Strike(FaultKind::kUnplugged, now))
    return Unplug(now, fault->amount);
  shutter_.TakeControl();
  if (device_->Read(Register::kAcquisition) == 0) {
    device_->Write(Register::kTriggerSoftware, 0);
    return Forget();
  }
  if (IsTriggered(now)) {
    shutter_.Trigger(ReadSettings(), now);
    triggers_ = shutter_.triggers();
    if (!shutter_.in_control()) {
      device_->Write(Register::kControlChannelPrivilege, 0);
      return Forget();
    }
  }
  HandOver(now);
  Deliver(now);
  frames_ = sent_before_ + device_->sent();
}

// More pictures than a few in the darkroom, and triggers are ignored, as by a camera whose memory
// is full.
bool GigeCamera::IsTriggered(DeviceTime now) {
  bool triggered = false;
  if (device_->Read(Register::kTriggerMode) != 0) {
    triggered = device_->Read(Register::kTriggerSoftware) != 0;
    if (triggered) device_->Write(Register::kTriggerSoftware, 0);
  } else if (now >= next_free_frame_) {
    triggered = true;
    next_free_frame_ = now + microseconds(std::max(device_->Read(Register::kFramePeriodUs), 1000u));
  }
  const std::lock_guard lock(mutex_);
  return triggered && exposed_.size() + pictures_.size() < kBacklog;
}

// What drifted drifts for one frame, unless the client has written something else since.
CameraSettings GigeCamera::ReadSettings() {
  CameraSettings settings{static_cast<double>(device_->Read(Register::kExposureUs)),
                          device_->Read(Register::kGainTenthsDb) / 10.0};
  if (drifted_ && SameRegisters(settings, drifted_->actual)) {
    settings = drifted_->set;
    WriteSettings(settings);
  }
  drifted_.reset();
  return Adjust(settings);
}

void GigeCamera::WriteSettings(const CameraSettings& settings) {
  device_->Write(Register::kExposureUs, Rounded(settings.exposure_us));
  device_->Write(Register::kGainTenthsDb, Rounded(settings.gain_db * 10.0));
}

void GigeCamera::HandOver(DeviceTime now) {
  while (const Shot* next = shutter_.Next()) {
    if (next->end > now) return;
    const PixelFormat* format = FindPixelFormat(device_->Read(Register::kPixelFormat));
    const cv::Rect sensor(0, 0, studio_->rays.width(), studio_->rays.height());
    const auto even = [&](Register address) {
      return static_cast<int>(device_->Read(address) & ~1u);
    };
    const cv::Rect region(even(Register::kOffsetX), even(Register::kOffsetY),
                          even(Register::kWidth), even(Register::kHeight));
    const std::lock_guard lock(mutex_);
    exposed_.push_back({shutter_.Take(), format ? format : config_.format, region & sensor,
                        static_cast<double>(device_->Read(Register::kBlackLevelDn)), generation_});
    wake_.notify_all();
  }
}

void GigeCamera::Deliver(DeviceTime now) {
  const std::lock_guard lock(mutex_);
  if (pictures_.empty() || pictures_.front().shot.available > now) return;
  auto& [shot, frame] = pictures_.front();
  frame.timestamp_ns =
      NanosecondsSince1970() - static_cast<std::uint64_t>((now - shot.begin).count());
  if (!SameRegisters(shot.set, shot.actual)) {
    drifted_ = shot;
    WriteSettings(shot.actual);
  }
  if (device_->Send(frame)) pictures_.pop_front();
}

void GigeCamera::Forget() {
  shutter_.Clear();
  device_->ForgetUnsent();
  const std::lock_guard lock(mutex_);
  exposed_.clear();
  pictures_.clear();
  ++generation_;
}

void GigeCamera::Unplug(DeviceTime now, double ms) {
  Forget();
  drifted_.reset();
  sent_before_ += device_->sent();
  device_.reset();
  unplugged_until_ = now + DeviceTime(static_cast<std::int64_t>(ms * 1e6));
}

void GigeCamera::PlugIn(DeviceTime now) {
  if (now < unplugged_until_) return;
  auto device = FakeDevice::Start(AtPowerOn());
  if (!device) {
    unplugged_until_ = now + kReturnPeriod;
    return;
  }
  device_ = std::move(*device);
  SetUp();
}

// An angle that the table rests at whatever the time: a homing that never ends has none.
void GigeCamera::RenderAhead(DeviceTime now) {
  const double resting_deg = table_->TrueAngleDeg(now + hours(1));
  if (IsHandheld(*studio_) || ahead_deg_ == resting_deg ||
      resting_deg != table_->TrueAngleDeg(now + hours(2)))
    return;
  const std::lock_guard lock(mutex_);
  ahead_deg_ = wanted_deg_ = resting_deg;
  wake_.notify_all();
}

void GigeCamera::Develop() {
  std::unique_lock lock(mutex_);
  while (true) {
    wake_.wait(lock, [this] { return stopping_ || wanted_deg_ || !exposed_.empty(); });
    if (stopping_) return;
    if (exposed_.empty()) {
      const double angle_deg = *wanted_deg_;
      wanted_deg_.reset();
      lock.unlock();
      shutter_.Render(angle_deg);
      lock.lock();
      continue;
    }
    const Exposed exposed = exposed_.front();
    lock.unlock();
    Picture picture{exposed.shot, MakeFrame(exposed)};
    lock.lock();
    if (exposed.generation != generation_) continue;
    exposed_.pop_front();
    pictures_.push_back(std::move(picture));
  }
}

OutgoingFrame GigeCamera::MakeFrame(const Exposed& exposed) {
  const Sensor& sensor = config_.camera.scene.sensor;
  calib::Radiometry radiometry = RadiometryOf(studio_->radiometry, sensor, *exposed.format);
  radiometry.black = exposed.black_dn;
  const cv::Mat picture =
      shutter_.Develop(exposed.shot, SensorOf(sensor, *exposed.format), radiometry,
                       exposed.format->layout == PixelLayout::kMono);
  OutgoingFrame frame;
  frame.id = exposed.shot.id;
  frame.complete = exposed.shot.complete;
  frame.bytes = Pack(picture, *exposed.format, exposed.region);
  return frame;
}

}  // namespace turnlight::rig::sim::gige
