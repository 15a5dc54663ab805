// What the simulated GigE Vision camera is like: devices/camera of a simulator's config.
//
// Keys, all optional: address (IPv4), serial, pixel_format (at power-on; clients may change it),
// packet_loss (share of the packets that are lost), readout_ms, first_frame_id.
#pragma once

#include <string>

#include "base/result.h"
#include "base/strict_object.h"
#include "rig/rig_setup.h"
#include "rig/sim/gige/pixel_format.h"
#include "rig/sim/mock_config.h"
#include "rig/sim/mock_drivers.h"

namespace turnlight::rig::sim::gige {

struct CameraConfig {
  std::string address = "127.0.0.1";
  const PixelFormat* format = FindPixelFormat("RGB8");
  double packet_loss = 0.0;  // 0..0.5
  // With the scene. serial: 1 to 15 letters, digits, "-" and "_"; the scene's camera: of even size.
  MockCameraConfig camera;
};

// The camera that a simulator has without a word about it.
CameraConfig DefaultCamera(const SimulationConfig& simulation);
// Messages name file, line, key and what is allowed.
Result<CameraConfig> ReadCamera(StrictObject object, const SimulationConfig& simulation);

// Who it says that it is, and what is true of its pictures, in the format that it has at power-on.
DeviceIdentity IdentityOf(const CameraConfig& config);
RigKnowledge KnowledgeOf(const SimulatedWorld& world, const CameraConfig& config);

}  // namespace turnlight::rig::sim::gige
