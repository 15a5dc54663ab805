// The stream of a camera's buffers, with its counters.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

#include "base/result.h"
#include "rig/aravis/aravis_config.h"
#include "rig/aravis/connection.h"
#include "rig/aravis/gobject.h"
#include "rig/device.h"

namespace turnlight::rig::aravis {

class FrameStream {
 public:
  // Chooses the packet size, makes the stream and gives it its buffers. Nothing flows yet.
  static Result<FrameStream> Create(const Connection& connection, const AravisConfig& config,
                                    KnownCamera& known);

  // The next buffer, waiting for it; nothing if none comes. It goes back when it is let go.
  struct Return {
    ArvStream* stream;
    void operator()(ArvBuffer* buffer) const { arv_stream_push_buffer(stream, buffer); }
  };
  using Buffer = std::unique_ptr<ArvBuffer, Return>;
  Buffer Pop(std::chrono::microseconds patience);
  // Gives back all that are waiting; how many.
  int Drain();

  int packet_size() const { return packet_size_; }  // 0: not of GigE Vision
  std::vector<DeviceReading> Counters() const;

 private:
  explicit FrameStream(Owned<ArvStream> stream) : stream_(std::move(stream)) {}

  Owned<ArvStream> stream_;
  int packet_size_ = 0;
};

}  // namespace turnlight::rig::aravis
