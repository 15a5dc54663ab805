// Aravis' fake camera on the network: its registers, and the frames that it sends. What is exposed,
// and when, is decided elsewhere (rig/sim/gige/gige_camera.h).
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "base/result.h"
#include "rig/sim/gige/pixel_format.h"
#include "rig/sim/gige/registers.h"

namespace turnlight::rig::sim::gige {

struct FakeDeviceConfig {
  std::string address;  // IPv4: of the loopback, or of an interface of this machine
  std::string serial;   // 1 to 15 characters
  cv::Size sensor;      // even
  const PixelFormat* format = nullptr;
  int black_dn = 0;          // of that format
  double packet_loss = 0.0;  // 0..1
};

struct OutgoingFrame {
  std::uint64_t id = 0;            // 1..65535
  std::uint64_t timestamp_ns = 0;  // since 1970
  bool complete = true;            // false: packets are lost, the first of the picture among them
  std::vector<std::uint8_t> bytes;
};

class FakeDevice {
 public:
  // Fails (kDevice): it cannot listen there. Does not notice another camera.
  static Result<std::unique_ptr<FakeDevice>> Start(const FakeDeviceConfig& config);
  // Gone from the network; takes up to 100 ms.
  ~FakeDevice();
  FakeDevice(const FakeDevice&) = delete;
  FakeDevice& operator=(const FakeDevice&) = delete;

  std::uint32_t Read(Register address) const;
  void Write(Register address, std::uint32_t value);
  void WriteTimestamp(std::uint64_t ns_since_1970);

  // To be sent within a millisecond or two. False: the frame before has not been sent yet.
  bool Send(OutgoingFrame& frame);
  void ForgetUnsent();
  std::uint64_t sent() const;

 private:
  struct State;
  explicit FakeDevice(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace turnlight::rig::sim::gige
