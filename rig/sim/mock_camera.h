// A camera that is not there: it photographs a simulated scene at the mock table's true angle of
// the instant, moved or not.
//
// A trigger opens the shutter after trigger_latency_ms, and the frame can be polled readout_ms
// after the shutter has closed. A trigger before the previous picture's shutter has closed is
// ignored, as real cameras do. If the table turned by more than blur_threshold_deg while the
// shutter was open, the picture is the mean over blur_samples instants; else it is the scene at the
// angle of the middle of the exposure.
//
// Brightness: radiance 1 is the sensor's white at reference_exposure_us and 0 dB. Gain amplifies
// the signal and its noise.
//
// Noise is keyed by (seed, commanded angle in microdegrees, exposure and gain as they were set,
// pixel), never by attempt or clock: a picture taken again at the same commanded angle with the
// same settings is the same bits (design, section 10). Two pictures at one commanded angle
// therefore share their noise; 0 and 360 degrees are different angles.
//
// The picture is rendered by Poll, in the caller's thread (tens of milliseconds of processor time
// that the passed-in time does not see). Renders are cached by angle, so a retake costs the sensor
// only.
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "rig/device.h"
#include "rig/sim/fault_script.h"
#include "rig/sim/mock_config.h"
#include "rig/sim/mock_turntable.h"
#include "rig/sim/studio.h"

namespace turnlight::rig::sim {

// The studio of a camera's scene, its radiometry with both references. Fails like BuildStudio.
Result<Studio> BuildStudio(const MockCameraConfig& config);

// Not for several threads at once; the table may be moved by another.
class MockCamera : public Camera {
 public:
  // The config must be valid, and the studio that of its scene. No script: no faults.
  MockCamera(MockCameraConfig config, std::shared_ptr<const Studio> studio,
             std::shared_ptr<MockTurntable> table, std::shared_ptr<FaultScript> faults = nullptr);
  // With a studio of its own. Fails (kInput): an invalid config, lights that cannot be placed as
  // asked.
  static Result<std::unique_ptr<MockCamera>> Create(const MockCameraConfig& config,
                                                    std::shared_ptr<MockTurntable> table,
                                                    std::shared_ptr<FaultScript> faults = nullptr);
  ~MockCamera() override;

  // Settings are back at CameraSettings' defaults.
  Result<DeviceIdentity> Open(DeviceTime now) override;
  // Exposure: clipped to 10 us..10 s and rounded to 1 us; gain: to 0..24 dB, 0.1 dB.
  Result<CameraSettings> Set(const CameraSettings& settings, DeviceTime now) override;
  Result<int> Drain(DeviceTime now) override;
  Result<std::uint64_t> Trigger(DeviceTime now) override;
  Result<std::optional<RawFrame>> Poll(DeviceTime now) override;

  // What only a simulation knows. ----------------------------------------------------------------

  // Noise-free, the scene at rest at that true angle; coverage is the target's share of a pixel.
  estimator::target::Rendering StaticRender(double angle_deg, bool lit = true) const;
  // How far a frame is from the static render at that angle, value by value, in standard deviations
  // of its noise and of the rounding to whole DN. Mind the number of values: the largest of a
  // million normal ones is usually about 4.9.
  struct Deviation {
    double max_sigmas = 0.0;
    double rms_sigmas = 0.0;  // over the target's pixels; about 1 for a frame of that angle
    double share_beyond_5 = 0.0;
  };
  Deviation DeviationFromStatic(const RawFrame& frame, double angle_deg) const;
  const Studio& studio() const { return *studio_; }
  const MockCameraConfig& config() const { return config_; }

 private:
  struct Shot;
  struct Render {
    double angle_deg = 0.0;
    bool lit = true;
    cv::Mat3f radiance;
  };

  std::optional<FaultEntry> Strike(FaultKind kind, DeviceTime now);
  Status CheckLink(DeviceTime now);
  Shot NextShot(DeviceTime begin);
  void StrikeShot(Shot& shot, DeviceTime now);
  void Enqueue(Shot shot);
  RawFrame Develop(const Shot& shot);
  cv::Mat3f Expose(const Shot& shot);
  cv::Mat3f CachedRender(double angle_deg, bool lit);

  const MockCameraConfig config_;
  const std::shared_ptr<const Studio> studio_;
  const std::shared_ptr<MockTurntable> table_;
  const std::shared_ptr<FaultScript> faults_;
  CameraSettings settings_;
  bool open_ = false;
  bool in_control_ = false;
  DeviceTime unplugged_until_{};
  std::uint64_t triggers_ = 0;
  std::uint64_t next_id_;
  DeviceTime shutter_closed_{};
  std::vector<Shot> queue_;  // in the order of delivery
  std::optional<RawFrame> last_delivered_;
  std::vector<Render> renders_;  // the newest last
};

}  // namespace turnlight::rig::sim
