// One camera, found, opened and ours alone.
#pragma once

#include <optional>
#include <string>

#include "base/result.h"
#include "rig/aravis/aravis_config.h"
#include "rig/aravis/camera_lock.h"
#include "rig/aravis/gobject.h"
#include "rig/device.h"

namespace turnlight::rig::aravis {

// What makes opening the same camera again quick.
struct KnownCamera {
  std::string name;     // that Aravis opens without a search: an address, or an id; may be empty
  std::string serial;   // it must still have
  int packet_size = 0;  // 0: not negotiated yet
};

struct Connection {
  Owned<ArvCamera> camera;
  DeviceIdentity identity;
  bool network = false;   // GigE Vision; else USB3 Vision
  bool loopback = false;  // on this machine
};

// Opens the camera that id means and takes control of it. known is used, if it is filled in, and
// filled in. Fails (kDevice): nothing answers to the id (with the cameras that were seen), another
// client holds it (named as far as can be known), it is not the one it was.
Result<Connection> Connect(const std::string& id, CameraLock& lock,
                           std::optional<KnownCamera>& known);

}  // namespace turnlight::rig::aravis
