// How a simulated camera takes its pictures, whatever it is reached by: triggers become openings of
// the shutter, with the faults that strike them, and an opening becomes a picture of the scene at
// the table's true angle of its instant.
//
// A trigger opens the shutter after trigger_latency_ms. A trigger before the previous picture's
// shutter has closed is ignored, as real cameras do. If the table turned by more than
// blur_threshold_deg while the shutter was open, the picture is the mean over blur_samples
// instants; else it is the scene at the angle of the middle of the exposure.
//
// Brightness: radiance 1 is the sensor's white at reference_exposure_us and 0 dB. Gain amplifies
// the signal and its noise.
//
// Noise is keyed by (seed, commanded angle in microdegrees, exposure and gain as they were set,
// value), never by attempt or clock: a picture taken again at the same commanded angle with the
// same settings is the same bits (design, section 10). Two pictures at one commanded angle
// therefore share their noise; 0 and 360 degrees are different angles. With a prop
// (rig/sim/prop.h) or a camera that is carried (rig/sim/walk.h) it is keyed by the picture's
// number, too; the latter's angle is how far it was carried.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>

#include "rig/device.h"
#include "rig/sim/fault_script.h"
#include "rig/sim/mock_config.h"
#include "rig/sim/mock_turntable.h"
#include "rig/sim/render_cache.h"
#include "rig/sim/studio.h"

namespace turnlight::rig::sim {

// One opening of the shutter.
struct Shot {
  DeviceTime begin{}, end{};
  DeviceTime available{};  // the picture has been read out
  CameraSettings set, actual;
  std::uint64_t id = 0;
  std::uint64_t trigger = 0;
  std::uint64_t picture = 0;  // its number, from 0 on
  bool complete = true;
  bool lit = true;
  double light_factor = 1.0;
  bool saturated = false;
  bool black = false;
};

// Exposure clipped to 10 us..10 s and rounded to 1 us, gain to 0..24 dB and 0.1 dB. Both must be
// finite.
CameraSettings Adjust(const CameraSettings& settings);

// Not for several threads at once, but for Develop; the table may be moved by another.
class Shutter {
 public:
  // The config must be valid, and the studio that of its scene. No script: no faults. Renders are
  // kept up to cache_bytes.
  Shutter(MockCameraConfig config, std::shared_ptr<const Studio> studio,
          std::shared_ptr<MockTurntable> table, std::shared_ptr<FaultScript> faults,
          std::size_t cache_bytes);

  // Settings as Adjust gives them. What it exposes is in the queue.
  void Trigger(const CameraSettings& settings, DeviceTime now);
  std::uint64_t triggers() const { return triggers_; }
  // Of the shots in the queue, the one that is delivered next; null: none.
  const Shot* Next() const { return queue_.empty() ? nullptr : &queue_.front(); }
  // Only if there is a next one.
  Shot Take();
  // Throws away what has been read out by now. Returns how many.
  int Drain(DeviceTime now);
  void Clear() { queue_.clear(); }

  // Whether triggers have an effect; the fault control_lost ends that.
  bool in_control() const { return in_control_; }
  void TakeControl() { in_control_ = true; }

  // A fault of the camera, while the angle is commanded that is commanded now.
  std::optional<FaultEntry> Strike(FaultKind kind, DeviceTime now);

  // The picture of a shot whose shutter has closed by now, R, G, B or, for a grey sensor, the mean
  // of the three channels' radiance. sensor and radiometry are the scene's, or have other bits.
  cv::Mat Develop(const Shot& shot, const Sensor& sensor, const calib::Radiometry& radiometry,
                  bool grey);
  // Noise-free, the scene at rest at that true angle.
  cv::Mat3f Render(double angle_deg) { return cache_.Radiance({angle_deg}); }

 private:
  Shot MakeShot(const CameraSettings& settings, DeviceTime begin);
  void StrikeShot(Shot& shot, DeviceTime now);
  void Enqueue(Shot shot);
  // Of the table, or of a camera that is carried round.
  double AngleDeg(DeviceTime time) const;
  View ViewOf(const Shot& shot, double angle_deg) const;
  cv::Mat3f Expose(const Shot& shot);

  const MockCameraConfig config_;
  const std::shared_ptr<const Studio> studio_;
  const std::shared_ptr<MockTurntable> table_;
  const std::shared_ptr<FaultScript> faults_;
  RenderCache cache_;
  bool in_control_ = false;
  std::uint64_t triggers_ = 0;
  std::uint64_t next_id_;
  DeviceTime closed_{};
  std::deque<Shot> queue_;  // in the order of delivery
  std::optional<Shot> last_taken_;
};

}  // namespace turnlight::rig::sim
