// A GigE Vision camera that is not there, on the real protocol: a client on the network finds it,
// sets its registers, triggers it by software and gets packets with what a camera would see of the
// simulated table at that instant. How pictures are taken is that of the mock camera
// (rig/sim/shutter.h), so both give the same picture, noise included, at the same commanded angle
// and settings.
//
// Time is that of the world: nanoseconds of the steady clock since the world's origin. Frames carry
// the host's time of the exposure's begin. A trigger is noticed within about half a millisecond; a
// frame is sent when it has been exposed, read out and developed. The render of the angle where the
// table is going to rest is made while it moves.
//
// Faults (rig/sim/fault_script.h) on this protocol:
//   stale_frame, untriggered_frame  as they are described
//   duplicate_frame    sent with the same id; Aravis' own client throws such a frame away
//   dropped_frame      the id advances, nothing is sent
//   incomplete_frame   the frame's leader arrives, the first packet of its picture does not
//   exposure_drift, gain_drift  from the frame's arrival on the registers read back so, until the
//                      client writes them or triggers again
//   control_lost       nobody is in control, and nothing is sent until a client takes control
//   unplugged          gone from the network; back with the registers of power-on. Strikes while a
//                      client is in control
// lamp_off, flicker, blurred, saturated, all_black, trigger_ignored: as they are described.
//
// Settings that differ in the bits of the noise differ by 1 us or 0.1 dB, which is what the
// registers have. Without a trigger (TriggerMode Off) it runs freely at AcquisitionFrameRate.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "base/result.h"
#include "rig/sim/gige/address_lock.h"
#include "rig/sim/gige/camera_config.h"
#include "rig/sim/gige/fake_device.h"
#include "rig/sim/mock_drivers.h"
#include "rig/sim/shutter.h"

namespace turnlight::rig::sim::gige {

class GigeCamera {
 public:
  using Clock = std::chrono::steady_clock;

  // The world must have its table, whoever moves it. Fails (kInput): the address is taken, or none
  // of this machine.
  static Result<std::unique_ptr<GigeCamera>> Start(const CameraConfig& config,
                                                   const SimulatedWorld& world,
                                                   Clock::time_point origin);
  // Leaves the network. Takes up to about 100 ms, or as long as a render that has begun.
  ~GigeCamera();
  GigeCamera(const GigeCamera&) = delete;
  GigeCamera& operator=(const GigeCamera&) = delete;

  struct Counts {
    std::uint64_t triggers = 0;  // also those that were ignored
    std::uint64_t frames = 0;    // sent
  };
  Counts counts() const { return {triggers_, frames_}; }

 private:
  struct Picture {
    Shot shot;
    OutgoingFrame frame;
  };
  // A shot whose shutter has closed, and the picture that the registers ask for.
  struct Exposed {
    Shot shot;
    const PixelFormat* format;
    cv::Rect region;
    double black_dn;
    std::uint64_t generation;
  };

  GigeCamera(CameraConfig config, const SimulatedWorld& world, Clock::time_point origin,
             AddressLock lock);

  DeviceTime Now() const { return Clock::now() - origin_; }
  FakeDeviceConfig AtPowerOn() const;
  void SetUp();
  // The worker: clients, triggers, delivery.
  void Work();
  void Pass(DeviceTime now);
  bool IsTriggered(DeviceTime now);
  CameraSettings ReadSettings();
  void WriteSettings(const CameraSettings& settings);
  void HandOver(DeviceTime now);
  void Deliver(DeviceTime now);
  void Forget();
  void Unplug(DeviceTime now, double ms);
  void PlugIn(DeviceTime now);
  void RenderAhead(DeviceTime now);
  // The darkroom: pictures, and renders ahead.
  void Develop();
  OutgoingFrame MakeFrame(const Exposed& exposed);

  const CameraConfig config_;
  const AddressLock lock_;
  const std::shared_ptr<const Studio> studio_;
  const std::shared_ptr<MockTurntable> table_;
  const Clock::time_point origin_;
  Shutter shutter_;

  // Of the worker alone.
  std::unique_ptr<FakeDevice> device_;  // null while it is unplugged
  DeviceTime unplugged_until_{};
  DeviceTime next_free_frame_{};
  std::uint64_t sent_before_ = 0;    // by devices that were unplugged
  std::optional<Shot> drifted_;      // the registers show its actual settings
  std::optional<double> ahead_deg_;  // the last angle that was rendered ahead

  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<Exposed> exposed_;
  std::deque<Picture> pictures_;
  std::optional<double> wanted_deg_;  // to be rendered ahead
  std::uint64_t generation_ = 0;      // pictures of an earlier one are thrown away
  bool stopping_ = false;
  std::atomic<bool> stopped_{false};
  std::atomic<std::uint64_t> triggers_{0}, frames_{0};
  std::thread worker_, darkroom_;
};

}  // namespace turnlight::rig::sim::gige
