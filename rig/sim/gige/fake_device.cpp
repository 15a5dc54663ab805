#include "rig/sim/gige/fake_device.h"

#include <arpa/inet.h>
#include <arv.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cstring>
#include <mutex>
#include <optional>
#include <utility>

#include "base/file.h"
#include "rig/sim/gige/genicam_xml.h"
#include "rig/sim/gige/loopback_interface.h"

namespace turnlight::rig::sim::gige {
namespace {

// How often a second the fake looks whether a frame is to be sent.
constexpr double kSendPollsPerSecond = 1000.0;
// Of an incomplete frame.
constexpr double kIncompleteLoss = 0.5;
constexpr std::size_t kTextBytes = 32;
// Bit 1 of a MAC's first byte: given out locally.
constexpr std::uint32_t kMacHigh = 0x0200;

// The fake reads its XML from a file that has to have a name.
class XmlFile {
 public:
  XmlFile() : fd_(::memfd_create("genicam.xml", MFD_CLOEXEC)) {
    if (fd_ >= 0 && !WriteAll(fd_, GenicamXml())) {
      ::close(fd_);
      fd_ = -1;
    }
  }
  ~XmlFile() {
    if (fd_ >= 0) ::close(fd_);
  }
  XmlFile(const XmlFile&) = delete;
  XmlFile& operator=(const XmlFile&) = delete;
  bool good() const { return fd_ >= 0; }
  std::string name() const { return "/proc/self/fd/" + std::to_string(fd_); }

 private:
  int fd_;
};

void WriteText(ArvFakeCamera* camera, Register address, const char* text) {
  char bytes[kTextBytes] = {};
  std::strncpy(bytes, text, kTextBytes - 1);
  arv_fake_camera_write_memory(camera, static_cast<guint32>(address), kTextBytes, bytes);
}

// A seed of GLib's random numbers, which decide the fake's losses, by which the leader of a frame
// arrives and the first packet of its picture does not; another one each time.
guint32 SeedThatLosesAPacket() {
  for (guint32 seed = g_random_int();; ++seed) {
    GRand* random = g_rand_new_with_seed(seed);
    const bool leader = g_rand_double(random) >= kIncompleteLoss;
    const bool first = g_rand_double(random) >= kIncompleteLoss;
    g_rand_free(random);
    if (leader && !first) return seed;
  }
}

}  // namespace

struct FakeDevice::State {
  ~State() {
    if (camera) g_object_unref(camera);
  }
  ArvFakeCamera* registers() const { return arv_gv_fake_camera_get_fake_camera(camera); }
  void Fill(ArvBuffer* buffer);

  ArvGvFakeCamera* camera = nullptr;
  double packet_loss = 0.0;
  bool loses_more = false;  // only the fake's thread looks at it
  std::mutex mutex;
  std::optional<OutgoingFrame> unsent;
  std::atomic<std::uint64_t> sent{0};
};

// In the fake's thread, which sends the buffer afterwards.
void FakeDevice::State::Fill(ArvBuffer* buffer) {
  std::optional<OutgoingFrame> frame;
  {
    const std::lock_guard lock(mutex);
    frame.swap(unsent);
  }
  std::size_t known_size = 0;
  // The fake has checked that the buffer holds a payload; it tells no size.
  void* data = const_cast<void*>(arv_buffer_get_data(buffer, &known_size));
  const std::size_t payload = arv_fake_camera_get_payload(registers());
  std::size_t filled = 0;
  const bool incomplete = frame && !frame->complete;
  if (frame) {
    filled = std::min(payload, frame->bytes.size());
    std::memcpy(data, frame->bytes.data(), filled);
    arv_buffer_set_frame_id(buffer, frame->id);
    arv_buffer_set_timestamp(buffer, frame->timestamp_ns);
    ++sent;
  }
  std::memset(static_cast<char*>(data) + filled, 0, payload - filled);
  if (incomplete || loses_more) {
    g_object_set(camera, "gvsp-lost-ratio", incomplete ? kIncompleteLoss : packet_loss, nullptr);
    loses_more = incomplete;
  }
  if (incomplete) g_random_set_seed(SeedThatLosesAPacket());
}

FakeDevice::FakeDevice(std::unique_ptr<State> state) : state_(std::move(state)) {}
FakeDevice::~FakeDevice() = default;

Result<std::unique_ptr<FakeDevice>> FakeDevice::Start(const FakeDeviceConfig& config) {
  const XmlFile xml;
  if (!xml.good()) return SystemError(std::string("memfd_create: ") + std::strerror(errno));
  auto state = std::make_unique<State>();
  {
    const LoopbackInterface loopback(config.address);
    state->camera = arv_gv_fake_camera_new_full(config.address.c_str(), config.serial.c_str(),
                                                xml.name().c_str());
  }
  if (!arv_gv_fake_camera_is_running(state->camera))
    return DeviceError(config.address + ":3956: a camera cannot listen there");
  state->packet_loss = config.packet_loss;
  g_object_set(state->camera, "gvsp-lost-ratio", config.packet_loss, nullptr);
  ArvFakeCamera* registers = state->registers();
  WriteText(registers, Register::kManufacturerName, kVendorName);
  WriteText(registers, Register::kModelName, kModelName);
  in_addr address{};
  ::inet_pton(AF_INET, config.address.c_str(), &address);
  const std::pair<Register, std::uint32_t> at_power_on[] = {
      // Clients tell cameras apart by it.
      {Register::kMacHigh, kMacHigh},
      {Register::kMacLow, ntohl(address.s_addr)},
      {Register::kSensorWidth, config.sensor.width},
      {Register::kSensorHeight, config.sensor.height},
      {Register::kWidth, config.sensor.width},
      {Register::kHeight, config.sensor.height},
      {Register::kPixelFormat, config.format->code},
      {Register::kBlackLevelDn, config.black_dn},
      {Register::kSendMode, 1},
      {Register::kSendSource, 1}};
  std::unique_ptr<FakeDevice> device(new FakeDevice(std::move(state)));
  for (const auto& [at, value] : at_power_on) device->Write(at, value);
  arv_fake_camera_set_trigger_frequency(registers, kSendPollsPerSecond);
  arv_fake_camera_set_fill_pattern(
      registers,
      [](ArvBuffer* buffer, void* user, guint32, guint32, ArvPixelFormat) {
        static_cast<State*>(user)->Fill(buffer);
      },
      device->state_.get());
  return device;
}

std::uint32_t FakeDevice::Read(Register address) const {
  guint32 value = 0;
  arv_fake_camera_read_register(state_->registers(), static_cast<guint32>(address), &value);
  return value;
}

void FakeDevice::Write(Register address, std::uint32_t value) {
  arv_fake_camera_write_register(state_->registers(), static_cast<guint32>(address), value);
}

// Both halves in one write, so that nobody reads halves of different times.
void FakeDevice::WriteTimestamp(std::uint64_t ns_since_1970) {
  const std::uint64_t big_endian = GUINT64_TO_BE(ns_since_1970);
  arv_fake_camera_write_memory(state_->registers(), static_cast<guint32>(Register::kTimestampHigh),
                               sizeof big_endian, &big_endian);
}

bool FakeDevice::Send(OutgoingFrame& frame) {
  {
    const std::lock_guard lock(state_->mutex);
    if (state_->unsent) return false;
    state_->unsent = std::move(frame);
  }
  Write(Register::kSend, 1);
  return true;
}

void FakeDevice::ForgetUnsent() {
  const std::lock_guard lock(state_->mutex);
  if (!state_->unsent) return;
  state_->unsent.reset();
  Write(Register::kSend, 0);
}

std::uint64_t FakeDevice::sent() const { return state_->sent; }

}  // namespace turnlight::rig::sim::gige
