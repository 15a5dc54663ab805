// The driver's camera in a test: its config, its time, a whole shot.
#pragma once

#include <string>

#include "fake_camera.h"
#include "rig/aravis/aravis_camera.h"

namespace turnlight::rig::aravis {

// 64 x 48 pixels, at this process's address.
AravisConfig Config(const std::string& pixel_format);
DeviceTime Now();
// Byte number i is i, modulo 256.
void Ramp(const FakeCamera::Picture& picture);
// Drains, triggers, and polls for up to 5 s.
Result<RawFrame> Shoot(AravisCamera& camera);

}  // namespace turnlight::rig::aravis
