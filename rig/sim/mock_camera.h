// A camera that is not there: it photographs a simulated scene at the mock table's true angle of
// the instant, moved or not.
//
// rig/sim/shutter.h says how pictures are taken, and how their noise is keyed. A frame can be
// polled readout_ms after the shutter has closed.
//
// The picture is rendered by Poll, in the caller's thread (tens of milliseconds of processor time
// that the passed-in time does not see). Renders are cached by angle, so a retake costs the sensor
// only.
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>

#include "base/result.h"
#include "rig/device.h"
#include "rig/sim/fault_script.h"
#include "rig/sim/mock_config.h"
#include "rig/sim/mock_turntable.h"
#include "rig/sim/shutter.h"
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
  // As Adjust does.
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
  Status CheckLink(DeviceTime now);

  const MockCameraConfig config_;
  const std::shared_ptr<const Studio> studio_;
  Shutter shutter_;
  CameraSettings settings_;
  bool open_ = false;
  DeviceTime unplugged_until_{};
};

}  // namespace turnlight::rig::sim
