#include "test_camera.h"

#include <thread>

namespace turnlight::rig::aravis {

AravisConfig Config(const std::string& pixel_format) {
  AravisConfig config;
  config.id = TestAddress();
  config.format = FindPixelFormat(pixel_format).value();
  config.size = {64, 48};
  config.readout_ms = 10.0;
  return config;
}

DeviceTime Now() {
  return std::chrono::duration_cast<DeviceTime>(Steady::now().time_since_epoch());
}

void Ramp(const FakeCamera::Picture& picture) {
  for (std::size_t i = 0; i < picture.bytes; ++i) picture.data[i] = static_cast<std::uint8_t>(i);
}

Result<RawFrame> Shoot(AravisCamera& camera) {
  if (const auto drained = camera.Drain(Now()); !drained) return Forward(drained);
  if (const auto trigger = camera.Trigger(Now()); !trigger) return Forward(trigger);
  for (const DeviceTime until = Now() + std::chrono::seconds(5); Now() < until;) {
    auto frame = camera.Poll(Now());
    if (!frame) return Forward(frame);
    if (*frame) return std::move(**frame);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return DeviceError("no picture");
}

}  // namespace turnlight::rig::aravis
