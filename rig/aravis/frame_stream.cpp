#include "rig/aravis/frame_stream.h"

#include <utility>

namespace turnlight::rig::aravis {
namespace {

constexpr int kBuffers = 4;
constexpr int kLoopbackPacketSize = 9000;
// How long a picture with holes is kept for its missing packets, microseconds. On loopback nothing
// comes late, and the simulated camera sends nothing again.
constexpr unsigned kRetentionUs = 200000;
constexpr unsigned kLoopbackRetentionUs = 20000;

Result<int> ChoosePacketSize(const Connection& connection, const AravisConfig& config,
                             const KnownCamera& known) {
  ArvCamera* camera = connection.camera.get();
  Failure failure;
  arv_camera_gv_set_packet_size_adjustment(camera, ARV_GV_PACKET_SIZE_ADJUSTMENT_NEVER);
  int size = config.packet_size.value_or(known.packet_size);
  if (size == 0 && connection.loopback) size = kLoopbackPacketSize;
  if (size == 0) {
    arv_camera_gv_auto_packet_size(camera, failure.out());
  } else {
    arv_camera_gv_set_packet_size(camera, size, failure.out());
  }
  if (failure) return DeviceError("packet size: " + failure.text());
  const auto now = static_cast<int>(arv_camera_gv_get_packet_size(camera, failure.out()));
  if (failure) return DeviceError("packet size: " + failure.text());
  if (config.packet_size && now != *config.packet_size)
    return DeviceError("packet_size: " + std::to_string(*config.packet_size) +
                       " was asked for, the camera has " + std::to_string(now));
  return now;
}

}  // namespace

Result<FrameStream> FrameStream::Create(const Connection& connection, const AravisConfig& config,
                                        KnownCamera& known) {
  ArvCamera* camera = connection.camera.get();
  int packet_size = 0;
  if (connection.network) {
    const auto chosen = ChoosePacketSize(connection, config, known);
    if (!chosen) return Forward(chosen);
    packet_size = known.packet_size = *chosen;
    arv_camera_gv_set_stream_options(camera, config.packet_socket
                                                 ? ARV_GV_STREAM_OPTION_NONE
                                                 : ARV_GV_STREAM_OPTION_PACKET_SOCKET_DISABLED);
  }
  Failure failure;
  Owned<ArvStream> stream(arv_camera_create_stream(camera, nullptr, nullptr, failure.out()));
  if (!stream) return DeviceError("no stream: " + failure.text());
  if (ARV_IS_GV_STREAM(stream.get())) {
    const bool resend = config.packet_resend && !connection.loopback;
    g_object_set(stream.get(), "socket-buffer", ARV_GV_STREAM_SOCKET_BUFFER_FIXED,
                 "socket-buffer-size", config.socket_buffer_kb * 1000, "packet-resend",
                 resend ? ARV_GV_STREAM_PACKET_RESEND_ALWAYS : ARV_GV_STREAM_PACKET_RESEND_NEVER,
                 "frame-retention", connection.loopback ? kLoopbackRetentionUs : kRetentionUs,
                 nullptr);
  }
  const guint payload = arv_camera_get_payload(camera, failure.out());
  if (failure) return DeviceError("PayloadSize: " + failure.text());
  for (int i = 0; i < kBuffers; ++i)
    arv_stream_push_buffer(stream.get(), arv_buffer_new_allocate(payload));
  FrameStream made(std::move(stream));
  made.packet_size_ = packet_size;
  return made;
}

FrameStream::Buffer FrameStream::Pop(std::chrono::microseconds patience) {
  return Buffer(patience.count() > 0 ? arv_stream_timeout_pop_buffer(
                                           stream_.get(), static_cast<guint64>(patience.count()))
                                     : arv_stream_try_pop_buffer(stream_.get()),
                Return{stream_.get()});
}

int FrameStream::Drain() {
  int drained = 0;
  while (drained < kBuffers && Pop(std::chrono::microseconds(0))) ++drained;
  return drained;
}

std::vector<DeviceReading> FrameStream::Counters() const {
  guint64 completed = 0, failures = 0, underruns = 0;
  arv_stream_get_statistics(stream_.get(), &completed, &failures, &underruns);
  std::vector<DeviceReading> readings{{"StreamCompleted", static_cast<double>(completed)},
                                      {"StreamFailures", static_cast<double>(failures)},
                                      {"StreamUnderruns", static_cast<double>(underruns)}};
  if (ARV_IS_GV_STREAM(stream_.get())) {
    guint64 resent = 0, missing = 0;
    arv_gv_stream_get_statistics(ARV_GV_STREAM(stream_.get()), &resent, &missing);
    readings.push_back({"PacketsResent", static_cast<double>(resent)});
    readings.push_back({"PacketsMissing", static_cast<double>(missing)});
  }
  return readings;
}

}  // namespace turnlight::rig::aravis
