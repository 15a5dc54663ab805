// A simulated camera and table in this process, and a plain client of Aravis' that knows nothing of
// turnlight's drivers. Each test has addresses of its own, so that tests can run side by side.
#pragma once

#include <arv.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rig/sim/gige/gige_camera.h"

namespace turnlight::rig::sim::gige {

// 127.x.y.z of this process, another one for each number 0..9.
std::string OwnAddress(int number = 0);

// A lump in colour, 64 x 48, with noise; the camera at OwnAddress().
SimulationConfig SmallSimulation();
CameraConfig SmallCamera(const SimulationConfig& simulation, const char* pixel_format = "RGB8");

struct ClientFrame {
  ArvBufferStatus status = ARV_BUFFER_STATUS_UNKNOWN;
  std::uint64_t id = 0, timestamp_ns = 0;
  int width = 0, height = 0;
  std::uint32_t format = 0;
  std::vector<std::uint8_t> bytes;
  bool good() const { return status == ARV_BUFFER_STATUS_SUCCESS; }
};

// Test failures say what went wrong with the client.
class Client {
 public:
  explicit Client(const std::string& address);
  ~Client();
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;
  bool open() const { return camera_ != nullptr; }

  ArvDevice* device() const { return arv_camera_get_device(camera_); }
  ArvCamera* camera() const { return camera_; }
  double Float(const char* feature) const;
  std::int64_t Integer(const char* feature) const;
  std::string Text(const char* feature) const;
  void Set(const char* feature, double value) const;
  void Set(const char* feature, std::int64_t value) const;
  void Set(const char* feature, const char* value) const;

  // Streaming with UDP sockets.
  void Start(bool triggered = true, int packet_bytes = 9000);
  void Stop();
  void Trigger() const;
  // The next frame of any status, or none within so long.
  std::optional<ClientFrame> Pop(int timeout_ms = 3000) const;
  // Trigger, and the next good frame.
  ClientFrame Shoot() const;

 private:
  ArvCamera* camera_ = nullptr;
  ArvStream* stream_ = nullptr;
};

// A world with a homed table that moves at once, and a camera in it.
struct GigeBench {
  explicit GigeBench(std::vector<FaultEntry> faults = {}, const char* pixel_format = "RGB8",
                     const std::function<void(CameraConfig&)>& change = {});
  DeviceTime Now() const { return GigeCamera::Clock::now() - origin; }
  // Until it stands at the angle.
  void Move(double angle_deg);
  // What the mock camera takes at that angle, R, G, B, with values of so many bits.
  cv::Mat Picture(double angle_deg, int bits, const CameraSettings& settings = {}) const;

  SimulatedWorld world;
  GigeCamera::Clock::time_point origin = GigeCamera::Clock::now();
  CameraConfig config;
  std::unique_ptr<GigeCamera> camera;
};

FaultEntry CameraFault(FaultKind kind, std::optional<double> angle_deg = {});

}  // namespace turnlight::rig::sim::gige
