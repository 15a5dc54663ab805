#include "rig/aravis/connection.h"

#include <chrono>
#include <thread>
#include <utility>

#include "base/format.h"
#include "rig/aravis/features.h"
#include "rig/aravis/find_cameras.h"
#include "rig/aravis/reap.h"

namespace turnlight::rig::aravis {
namespace {

// Bootstrap registers of GigE Vision.
constexpr std::uint64_t kPrimaryApplicationPort = 0x0a04;
constexpr std::uint64_t kPrimaryApplicationAddress = 0x0a14;

constexpr std::chrono::milliseconds kHeartbeatOver(4000);

bool IsAddress(const std::string& text) {
  const Owned<GInetAddress> address(g_inet_address_new_from_string(text.c_str()));
  return address != nullptr;
}

// "cam-left.lab": letters, digits, hyphens and points, and not a number alone.
bool MayBeHostName(const std::string& text) {
  bool letter = false;
  for (const char c : text) {
    if (!g_ascii_isalnum(c) && c != '-' && c != '.') return false;
    letter = letter || g_ascii_isalpha(c);
  }
  return letter && text.size() <= 253;
}

std::string AddressOfHost(const std::string& name) {
  const Owned<GResolver> resolver(g_resolver_get_default());
  Failure failure;
  GList* const list =
      g_resolver_lookup_by_name(resolver.get(), name.c_str(), nullptr, failure.out());
  std::string address;
  for (const GList* at = list; at && address.empty(); at = at->next)
    if (g_inet_address_get_family(G_INET_ADDRESS(at->data)) == G_SOCKET_FAMILY_IPV4) {
      const std::unique_ptr<char, Free> text(g_inet_address_to_string(G_INET_ADDRESS(at->data)));
      address = text.get();
    }
  g_resolver_free_addresses(list);
  return address;
}

// What Aravis opens by itself: an address as it stands, else what a search finds.
Result<std::string> NameOf(const std::string& id) {
  if (IsAddress(id)) return id;
  const auto cameras = FindCameras();
  if (!cameras) return Forward(cameras);
  if (const auto camera = CameraOf(*cameras, id))
    return camera->protocol == "GigEVision" ? camera->address : camera->id;
  if (MayBeHostName(id))
    if (std::string address = AddressOfHost(id); !address.empty()) return address;
  return DeviceError("no camera answers to \"" + id + "\"; " + DescribeCameras(*cameras));
}

std::string AddressOf(ArvGvDevice* device) {
  auto* socket = G_INET_SOCKET_ADDRESS(arv_gv_device_get_device_address(device));
  const std::unique_ptr<char, Free> text(
      g_inet_address_to_string(g_inet_socket_address_get_address(socket)));
  return text.get();
}

// Who has it, by the camera's own registers; makers may leave them empty.
std::string DescribeHolder(Features& features) {
  const auto address = features.Register(kPrimaryApplicationAddress);
  const auto port = features.Register(kPrimaryApplicationPort);
  if (!address || !port || *address == 0)
    return "another client controls it; the camera does not say which";
  return Format("the client at %u.%u.%u.%u, port %u, controls it", *address >> 24,
                *address >> 16 & 255, *address >> 8 & 255, *address & 255, *port & 0xffff);
}

DeviceIdentity IdentityOf(ArvCamera* camera) {
  const auto text = [&](auto get) -> std::string {
    Failure failure;
    const char* value = get(camera, failure.out());
    return value ? value : "";
  };
  DeviceIdentity identity{text(arv_camera_get_vendor_name), text(arv_camera_get_model_name),
                          text(arv_camera_get_device_serial_number)};
  if (identity.serial.empty()) identity.serial = text(arv_camera_get_device_id);
  return identity;
}

// A program of this machine that was killed is in control until the camera misses its heartbeat, by
// the standard 3 s; a client that lives stays.
bool ControlComesFree(ArvGvDevice* device) {
  const auto until = std::chrono::steady_clock::now() + kHeartbeatOver;
  while (true) {
    Failure failure;
    if (arv_gv_device_take_control(device, failure.out())) return true;
    if (std::chrono::steady_clock::now() >= until) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
  }
}

// The same camera as before, locked, and under our control.
Status MakeOurs(Connection& connection, CameraLock& lock, const std::optional<KnownCamera>& known) {
  const DeviceIdentity& identity = connection.identity;
  if (known && known->serial != identity.serial)
    return DeviceError("at " + known->name + " there is now the camera with serial " +
                       identity.serial + ", it was " + known->serial);
  ArvDevice* device = arv_camera_get_device(connection.camera.get());
  connection.network = ARV_IS_GV_DEVICE(device);
  std::string serial = identity.serial;
  if (connection.network) {
    const std::string address = AddressOf(ARV_GV_DEVICE(device));
    connection.loopback = address.starts_with("127.");
    // Simulated cameras may all have the same number.
    if (connection.loopback) serial += "_" + address;
  }
  if (Status taken = lock.Take(identity.vendor, serial); !taken) return taken;
  if (!connection.network) return {};
  if (arv_gv_device_is_controller(ARV_GV_DEVICE(device))) return {};
  if (!known && ControlComesFree(ARV_GV_DEVICE(device))) return {};
  Features features(device);
  return DeviceError("camera " + identity.serial + ": " + DescribeHolder(features));
}

}  // namespace

Result<Connection> Connect(const std::string& id, CameraLock& lock,
                           std::optional<KnownCamera>& known) {
  std::string name = known ? known->name : "";
  if (name.empty()) {
    const auto found = NameOf(id);
    if (!found) return Forward(found);
    name = *found;
  }
  Failure failure;
  Connection connection;
  connection.camera.reset(arv_camera_new(name.c_str(), failure.out()));
  if (!connection.camera) {
    std::string text = "camera \"" + id + "\" does not open: " + failure.text();
    if (known) {
      known->name.clear();  // it may come back at another address
    } else if (const auto cameras = FindCameras()) {
      text += "; " + DescribeCameras(*cameras);
      if (id.starts_with("127."))
        text += "; at an address of this computer there is a camera while turnlight simulate runs";
    }
    return DeviceError(text);
  }
  connection.identity = IdentityOf(connection.camera.get());
  if (Status owned = MakeOurs(connection, lock, known); !owned) {
    Reap(std::move(connection.camera));
    return Forward(owned);
  }
  if (!known) known = KnownCamera{"", connection.identity.serial, 0};
  known->name = name;
  return connection;
}

}  // namespace turnlight::rig::aravis
