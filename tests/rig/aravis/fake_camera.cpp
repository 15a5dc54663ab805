#include "fake_camera.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <ifaddrs.h>
#include <netinet/in.h>
#include <signal.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <stdexcept>

namespace turnlight::rig::aravis {
namespace {

constexpr char kServeVariable[] = "TURNLIGHT_TEST_SERVE_CAMERA";

// Serves a camera instead of running tests, if the process was begun for that.
bool ServeIfAsked() {
  const char* asked = std::getenv(kServeVariable);
  if (!asked) return false;
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  FakeCamera camera(Xml(Description()), nullptr, asked);
  const char ready = 'r';
  if (::write(STDOUT_FILENO, &ready, 1) != 1) ::_exit(1);
  while (true) ::pause();
}
[[maybe_unused]] const bool kServes = ServeIfAsked();

}  // namespace

std::string TestAddress() {
  if (const char* given = std::getenv("TURNLIGHT_TEST_ADDRESS")) return given;
  const int pid = ::getpid();
  return "127." + std::to_string(pid / 62500 % 250 + 1) + "." +
         std::to_string(pid / 250 % 250 + 1) + "." + std::to_string(pid % 250 + 2);
}

FakeCamera::FakeCamera(const std::string& xml, Fill fill, const std::string& serial)
    : fill_(std::move(fill)) {
  if (!xml.empty()) {
    xml_path_ = "/tmp/turnlight_test_camera." + std::to_string(::getpid()) + "." + serial + ".xml";
    std::ofstream(xml_path_) << xml;
  }
  camera_.reset(arv_gv_fake_camera_new_full(TestAddress().c_str(), serial.c_str(),
                                            xml_path_.empty() ? nullptr : xml_path_.c_str()));
  if (!arv_gv_fake_camera_is_running(camera_.get()))
    throw std::runtime_error("no camera at " + TestAddress());
  ArvFakeCamera* camera = arv_gv_fake_camera_get_fake_camera(camera_.get());
  arv_fake_camera_set_trigger_frequency(camera, 1000.0);
  Write(ARV_FAKE_CAMERA_REGISTER_SENSOR_WIDTH, 640);
  Write(ARV_FAKE_CAMERA_REGISTER_SENSOR_HEIGHT, 480);
  Write(0x8000, 1);  // an enumeration's Continuous, a switch that is on
  if (fill_) arv_fake_camera_set_fill_pattern(camera, OnFill, this);
}

FakeCamera::~FakeCamera() {
  camera_.reset();
  if (!xml_path_.empty()) std::remove(xml_path_.c_str());
}

void FakeCamera::OnFill(ArvBuffer* buffer, void* self, guint32 exposure_us, guint32 gain,
                        ArvPixelFormat format) {
  std::size_t none = 0;
  auto* data = static_cast<std::uint8_t*>(
      const_cast<void*>(arv_buffer_get_data(buffer, &none)));  // NOLINT: it is to be filled
  const int width = arv_buffer_get_image_width(buffer);
  const int height = arv_buffer_get_image_height(buffer);
  const std::size_t bytes =
      static_cast<std::size_t>(width * height) * ARV_PIXEL_FORMAT_BIT_PER_PIXEL(format) / 8;
  static_cast<FakeCamera*>(self)->fill_({data, bytes, width, height, exposure_us, gain, buffer});
}

void FakeCamera::LosePackets(double share) {
  g_object_set(camera_.get(), "gvsp-lost-ratio", share, nullptr);
}

void FakeCamera::Write(std::uint32_t address, std::uint32_t value) {
  arv_fake_camera_write_register(arv_gv_fake_camera_get_fake_camera(camera_.get()), address, value);
}

std::uint32_t FakeCamera::Read(std::uint32_t address) const {
  guint32 value = 0;
  arv_fake_camera_read_register(arv_gv_fake_camera_get_fake_camera(camera_.get()), address, &value);
  return value;
}

void FakeCamera::WriteClock(std::int64_t ticks) {
  std::array<std::uint8_t, 8> bytes{};
  for (std::size_t i = 0; i < 8; ++i)
    bytes[i] = static_cast<std::uint8_t>(ticks >> (56 - 8 * i) & 255);
  arv_fake_camera_write_memory(arv_gv_fake_camera_get_fake_camera(camera_.get()), 0x8100, 8,
                               bytes.data());
}

CameraProcess::CameraProcess(const std::string& serial) {
  int out[2];
  if (::pipe2(out, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, out[1], STDOUT_FILENO);
  std::string serve = std::string(kServeVariable) + "=" + serial;
  std::string address = "TURNLIGHT_TEST_ADDRESS=" + TestAddress();
  char program[] = "/proc/self/exe";
  char* arguments[] = {program, nullptr};
  char* environment[] = {serve.data(), address.data(), nullptr};
  const int spawned = ::posix_spawn(&pid_, program, &actions, nullptr, arguments, environment);
  ::posix_spawn_file_actions_destroy(&actions);
  ::close(out[1]);
  char ready = 0;
  const bool up = spawned == 0 && ::read(out[0], &ready, 1) == 1;
  ::close(out[0]);
  if (!up) throw std::runtime_error("the camera's process did not begin");
}

CameraProcess::~CameraProcess() { Kill(); }

void CameraProcess::Freeze() {
  int status = 0;
  ::kill(pid_, SIGSTOP);
  ::waitpid(pid_, &status, WUNTRACED);  // until it stands
}

void CameraProcess::Thaw() { ::kill(pid_, SIGCONT); }

void CameraProcess::Kill() {
  if (pid_ < 0) return;
  ::kill(pid_, SIGKILL);
  ::waitpid(pid_, nullptr, 0);
  pid_ = -1;
}

}  // namespace turnlight::rig::aravis

// In place of the system's: loopback has this test's address.
extern "C" int getifaddrs(struct ifaddrs** list) {
  using Function = int (*)(struct ifaddrs**);
  static const auto system = reinterpret_cast<Function>(::dlsym(RTLD_NEXT, "getifaddrs"));
  const int result = system(list);
  for (struct ifaddrs* at = result == 0 ? *list : nullptr; at; at = at->ifa_next) {
    if (!at->ifa_addr || at->ifa_addr->sa_family != AF_INET) continue;
    auto* address = reinterpret_cast<struct sockaddr_in*>(at->ifa_addr);
    if (ntohl(address->sin_addr.s_addr) != INADDR_LOOPBACK) continue;
    unsigned a = 0, b = 0, c = 0, d = 0;
    std::sscanf(turnlight::rig::aravis::TestAddress().c_str(), "%u.%u.%u.%u", &a, &b, &c, &d);
    address->sin_addr.s_addr = htonl(a << 24 | b << 16 | c << 8 | d);
  }
  return result;
}
