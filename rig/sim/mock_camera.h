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
//
// Keys (all optional): serial, scene (the keys of rig/sim/synthetic_config.h; of its motion frames
// and step_deg mean nothing here, masks and sensor/clip_share must be left out),
// reference_exposure_us, trigger_latency_ms, readout_ms, blur_threshold_deg, blur_samples,
// first_frame_id, reports_trigger.
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "base/strict_object.h"
#include "rig/device.h"
#include "rig/sim/config_fields.h"
#include "rig/sim/fault_script.h"
#include "rig/sim/mock_turntable.h"
#include "rig/sim/studio.h"
#include "rig/sim/synthetic_config.h"

namespace turnlight::rig {

struct MockCameraConfig {
  std::string serial = "MOCK-CAMERA-1";
  SyntheticConfig scene;
  double reference_exposure_us = 8000.0;  // above 0
  double trigger_latency_ms = 0.2;        // 0..1000
  double readout_ms = 15.0;               // 0..10000
  double blur_threshold_deg = 1e-4;       // 0..10
  int blur_samples = 8;                   // 2..64
  int first_frame_id = 1;                 // 1..65535; ids wrap 65535 -> 1
  bool reports_trigger = false;           // whether frames say which trigger they answer
};

std::optional<ConfigProblem> Validate(const MockCameraConfig& config);
// Reads and validates; refuses unknown keys. Messages name file, line, key and what is allowed.
Result<MockCameraConfig> ReadMockCameraConfig(StrictObject object);

// Not for several threads at once; the table may be moved by another.
class MockCamera : public Camera {
 public:
  // Fails (kInput): an invalid config, lights that cannot be placed as asked. No script: no faults.
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
  estimator::target::Rendering StaticRender(double angle_deg) const;
  // How far a frame is from the static render at that angle, value by value, in standard deviations
  // of its noise and of the rounding to whole DN. Mind the number of values: the largest of a
  // million normal ones is usually about 4.9.
  struct Deviation {
    double max_sigmas = 0.0;
    double rms_sigmas = 0.0;  // over the target's pixels; about 1 for a frame of that angle
    double share_beyond_5 = 0.0;
  };
  Deviation DeviationFromStatic(const RawFrame& frame, double angle_deg) const;
  // What the session needs: lens, target, truth, and radiometry with both references filled in.
  const Studio& studio() const { return studio_; }
  Placement PlacementAt(double angle_deg) const { return PlaceAt(config_.scene.motion, angle_deg); }
  const MockCameraConfig& config() const { return config_; }

 private:
  struct Shot;
  struct Render {
    double angle_deg = 0.0;
    bool lit = true;
    cv::Mat3f radiance;
  };

  MockCamera(MockCameraConfig config, Studio studio, std::shared_ptr<MockTurntable> table,
             std::shared_ptr<FaultScript> faults);
  std::optional<FaultEntry> Strike(FaultKind kind, DeviceTime now);
  Status CheckLink(DeviceTime now);
  Shot NextShot(DeviceTime begin);
  void StrikeShot(Shot& shot, DeviceTime now);
  void Enqueue(Shot shot);
  RawFrame Develop(const Shot& shot);
  cv::Mat3f Expose(const Shot& shot);
  cv::Mat3f CachedRender(double angle_deg, bool lit);

  const MockCameraConfig config_;
  Studio studio_;
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

}  // namespace turnlight::rig
