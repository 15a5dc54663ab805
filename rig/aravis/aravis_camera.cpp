#include "rig/aravis/aravis_camera.h"

#include <algorithm>
#include <utility>

namespace turnlight::rig::aravis {
namespace {

using std::chrono::milliseconds;

// Longer than the 4 s of a search, an address where nobody is, and the first pictures.
constexpr milliseconds kFirstOpen(15000);
constexpr milliseconds kPatience(1000);
// Ending in order takes milliseconds; with a dead camera nobody waits for it.
constexpr milliseconds kEnd(500);

}  // namespace

AravisCamera::~AravisCamera() {
  if (worker_) worker_->End(kEnd);
}

tl::unexpected<Error> AravisCamera::Fault(const std::string& text) const {
  return DeviceError("camera \"" + config_.id + "\": " + text);
}

tl::unexpected<Error> AravisCamera::Silent() {
  open_ = false;
  return Fault("does not answer");
}

template <typename F>
auto AravisCamera::Do(F job) -> std::invoke_result_t<F, CameraWorker&> {
  if (!open_) return Fault("not open");
  auto handed = worker_->Hand(std::move(job));
  if (handed.WaitUntil(Steady::now() + kPatience)) return handed.result.get();
  *handed.cancelled = true;
  return Silent();
}

Result<DeviceIdentity> AravisCamera::Open(DeviceTime now) {
  clock_.Hear(now);
  open_ = false;
  if (!worker_) worker_ = CameraWorker::Begin(config_);
  const Steady::time_point until = Steady::now() + (opened_before_ ? kPatience : kFirstOpen);
  // What an earlier call began and did not wait for may have come to something; if it failed, that
  // says nothing of now.
  bool earlier = opening_.has_value();
  while (true) {
    if (!opening_) opening_ = worker_->Hand([](CameraWorker& worker) { return worker.Reopen(); });
    if (!opening_->WaitUntil(until))
      return Fault(opened_before_ ? "is not back yet" : "did not open in time");
    auto identity = opening_->result.get();
    opening_.reset();
    if (identity) {
      opened_before_ = open_ = true;
      ids_.Reconnected();
    }
    if (identity || !std::exchange(earlier, false)) return identity;
  }
}

Result<CameraSettings> AravisCamera::Set(const CameraSettings& settings, DeviceTime now) {
  clock_.Hear(now);
  return Do([settings](CameraWorker& worker) -> Result<CameraSettings> {
    return worker.session()->Set(settings);
  });
}

Result<int> AravisCamera::Drain(DeviceTime now) {
  clock_.Hear(now);
  return Do([](CameraWorker& worker) -> Result<int> {
    worker.ForgetShot();
    return worker.session()->Drain();
  });
}

Result<std::uint64_t> AravisCamera::Trigger(DeviceTime now) {
  clock_.Hear(now);
  const Status sent = Do([](CameraWorker& worker) -> Status {
    worker.ForgetShot();
    return worker.session()->Trigger();
  });
  if (!sent) return Forward(sent);
  return ++triggers_;
}

Result<std::optional<RawFrame>> AravisCamera::Poll(DeviceTime now) {
  clock_.Hear(now);
  if (!open_) return Fault("not open");
  auto shot = worker_->TakeShot();
  if (!shot) {
    if (worker_->Busy() > kPatience) return Silent();
    return std::optional<RawFrame>();
  }
  if (!*shot) return Fault(shot->error().text);
  ShotFrame& frame = **shot;
  return RawFrame{std::move(frame.image),
                  ids_.Next(frame.id),
                  triggers_,
                  clock_.ToCaller(frame.span.begin),
                  clock_.ToCaller(frame.span.end),
                  frame.actual,
                  true};
}

std::vector<std::string> AravisCamera::TakeNotes() {
  return worker_ ? worker_->TakeNotes() : std::vector<std::string>();
}

std::vector<DeviceReading> AravisCamera::Readings() { return Report().readings; }

CameraReport AravisCamera::Report() const { return worker_ ? worker_->Report() : CameraReport(); }

Result<CameraDevice> MakeAravisCamera(StrictObject keys) {
  auto config = ReadAravisConfig(std::move(keys));
  if (!config) return Forward(config);
  CameraDevice device;
  const PixelFormat& format = config->format;
  device.format = {config->size, format.Channels(), format.Depth()};
  device.bayer = format.bayer;
  device.binning = config->binning;
  for (std::size_t i = 0; i < 2; ++i) device.roi_offset[i] = config->offset[i] * config->binning[i];
  // Sixteen bits may hold the ten or more of the sensor in their lower end.
  device.full_scale_dn = {
      {format.bits == 16 ? 1023.0 : 0.5 * (format.MaxDn() + 1.0), format.MaxDn()}};
  device.readout_s = 1e-3 * config->readout_ms;
  device.real_time = true;
  device.camera = std::make_shared<AravisCamera>(std::move(*config));
  return device;
}

}  // namespace turnlight::rig::aravis
