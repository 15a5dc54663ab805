#include "tests/rig/sim/gige/gige_bench.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <thread>
#include <utility>

#include "base/parallel.h"
#include "rig/sim/mock_camera.h"

namespace turnlight::rig::sim::gige {
namespace {

// Says what an Aravis call complained of, and frees it.
class Complaint {
 public:
  ~Complaint() {
    EXPECT_EQ(error_, nullptr) << error_->message;
    g_clear_error(&error_);
  }
  operator GError**() { return &error_; }

 private:
  GError* error_ = nullptr;
};

// The thread sanitizer does not know how TBB synchronises.
class OneThread : public testing::Environment {
  void SetUp() override { SetThreads(1); }
};
[[maybe_unused]] const testing::Environment* const kOneThread =
    testing::AddGlobalTestEnvironment(new OneThread);

constexpr unsigned kSocketBytes = 4'000'000;
constexpr int kBuffers = 8;

}  // namespace

std::string OwnAddress(int number) {
  const int pid = ::getpid();
  return "127." + std::to_string(100 + number + 10 * (pid / 65024 % 15)) + "." +
         std::to_string(pid / 254 % 256) + "." + std::to_string(1 + pid % 254);
}

SimulationConfig SmallSimulation() {
  SimulationConfig simulation;
  SyntheticConfig& scene = simulation.camera.scene;
  scene.seed = 5;
  scene.target = Blob{40.0, 0.3, 24};
  scene.motion.kind = MotionKind::kTable;
  scene.camera = {.width = 64, .height = 48, .focal_px = 120.0, .distortion = {}};
  scene.lights = std::vector<LightSpec>{{{0.5, 0.3, 0.8}, 700.0, 0.5, {1, 1, 1}}};
  estimator::model::Reflectance reflectance;
  reflectance.albedo = {0.9, 0.7, 0.5};
  reflectance.ambient = 0.1;
  reflectance.diffuse = 0.8;
  scene.reflectance = reflectance;
  scene.sensor.noise_relative = 0.002;
  scene.sensor.noise_shot = 0.004;
  scene.samples_per_side = 2;
  simulation.table.max_speed_deg_s = 10000.0;
  simulation.table.acceleration_deg_s2 = 1e6;
  simulation.table.home_speed_deg_s = 10000.0;
  simulation.table.settle_ms = 0.0;
  return simulation;
}

CameraConfig SmallCamera(const SimulationConfig& simulation, const char* pixel_format) {
  CameraConfig config = DefaultCamera(simulation);
  config.address = OwnAddress();
  config.format = FindPixelFormat(std::string(pixel_format));
  config.camera.readout_ms = 1.0;
  return config;
}

Client::Client(const std::string& address) {
  GError* error = nullptr;
  camera_ = arv_camera_new(address.c_str(), &error);
  g_clear_error(&error);
}

Client::~Client() {
  if (stream_) Stop();
  if (camera_) g_object_unref(camera_);
}

double Client::Float(const char* feature) const {
  return arv_device_get_float_feature_value(device(), feature, Complaint());
}
std::int64_t Client::Integer(const char* feature) const {
  return arv_device_get_integer_feature_value(device(), feature, Complaint());
}
std::string Client::Text(const char* feature) const {
  const char* text = arv_device_get_string_feature_value(device(), feature, Complaint());
  return text ? text : "";
}
void Client::Set(const char* feature, double value) const {
  arv_device_set_float_feature_value(device(), feature, value, Complaint());
}
void Client::Set(const char* feature, std::int64_t value) const {
  arv_device_set_integer_feature_value(device(), feature, value, Complaint());
}
void Client::Set(const char* feature, const char* value) const {
  arv_device_set_string_feature_value(device(), feature, value, Complaint());
}

void Client::Start(bool triggered, int packet_bytes) {
  arv_camera_gv_set_packet_size_adjustment(camera_, ARV_GV_PACKET_SIZE_ADJUSTMENT_NEVER);
  arv_camera_gv_set_packet_size(camera_, packet_bytes, Complaint());
  arv_camera_gv_set_stream_options(camera_, ARV_GV_STREAM_OPTION_PACKET_SOCKET_DISABLED);
  if (triggered)
    arv_camera_set_trigger(camera_, "Software", Complaint());
  else
    arv_camera_clear_triggers(camera_, Complaint());
  stream_ = arv_camera_create_stream(camera_, nullptr, nullptr, Complaint());
  ASSERT_NE(stream_, nullptr);
  g_object_set(stream_, "socket-buffer", ARV_GV_STREAM_SOCKET_BUFFER_FIXED, "socket-buffer-size",
               kSocketBytes, "packet-resend", ARV_GV_STREAM_PACKET_RESEND_NEVER, "frame-retention",
               20000u, nullptr);
  const guint payload = arv_camera_get_payload(camera_, Complaint());
  for (int i = 0; i < kBuffers; ++i)
    arv_stream_push_buffer(stream_, arv_buffer_new_allocate(payload));
  arv_camera_start_acquisition(camera_, Complaint());
}

void Client::Stop() {
  GError* error = nullptr;  // the camera may be gone
  arv_camera_stop_acquisition(camera_, &error);
  g_clear_error(&error);
  g_clear_object(&stream_);
}

void Client::Trigger() const { arv_camera_software_trigger(camera_, Complaint()); }

std::optional<ClientFrame> Client::Pop(int timeout_ms) const {
  ArvBuffer* buffer =
      arv_stream_timeout_pop_buffer(stream_, static_cast<guint64>(timeout_ms) * 1000);
  if (!buffer) return std::nullopt;
  ClientFrame frame;
  frame.status = arv_buffer_get_status(buffer);
  frame.id = arv_buffer_get_frame_id(buffer);
  frame.timestamp_ns = arv_buffer_get_timestamp(buffer);
  if (frame.good()) {
    frame.width = arv_buffer_get_image_width(buffer);
    frame.height = arv_buffer_get_image_height(buffer);
    frame.format = arv_buffer_get_image_pixel_format(buffer);
    std::size_t size = 0;
    const auto* bytes = static_cast<const std::uint8_t*>(arv_buffer_get_data(buffer, &size));
    frame.bytes.assign(bytes, bytes + size);
  }
  arv_stream_push_buffer(stream_, buffer);
  return frame;
}

ClientFrame Client::Shoot() const {
  for (int attempt = 0; attempt < 5; ++attempt) {
    Trigger();
    const auto frame = Pop();
    if (frame && frame->good()) return *frame;
  }
  ADD_FAILURE() << "no good frame in five attempts";
  return {};
}

GigeBench::GigeBench(std::vector<FaultEntry> faults, const char* pixel_format,
                     const std::function<void(CameraConfig&)>& change) {
  SimulationConfig simulation = SmallSimulation();
  simulation.faults = std::move(faults);
  world = *BuildWorld(simulation);
  world.table = std::make_shared<MockTurntable>(simulation.table, world.faults);
  EXPECT_TRUE(world.table->Open(Now()));
  EXPECT_TRUE(world.table->Home(Now()));
  config = SmallCamera(simulation, pixel_format);
  if (change) change(config);
  auto started = GigeCamera::Start(config, world, origin);
  EXPECT_TRUE(started) << started.error().text;
  if (started) camera = std::move(*started);
}

void GigeBench::Move(double angle_deg) {
  while (world.table->State(Now())->motion == TableMotion::kMoving)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  const Status status = world.table->MoveTo(angle_deg, Now());
  EXPECT_TRUE(status) << status.error().text;
  while (world.table->State(Now())->motion == TableMotion::kMoving)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
}

cv::Mat GigeBench::Picture(double angle_deg, int bits, const CameraSettings& settings) const {
  MockCameraConfig mock = world.config.camera;
  mock.scene.sensor.depth = bits == 8 ? SensorDepth::k8 : SensorDepth::k16;
  mock.scene.sensor.white = (1 << bits) - 1;
  const auto table = std::make_shared<MockTurntable>(world.config.table);
  const auto mock_camera = MockCamera::Create(mock, table);
  DeviceTime now{};
  const auto later = [&now] { return now += std::chrono::seconds(20); };
  EXPECT_TRUE(mock_camera && table->Open(now) && table->Home(now));
  EXPECT_TRUE(table->MoveTo(angle_deg, later()));
  MockCamera& camera = **mock_camera;
  EXPECT_TRUE(camera.Open(later()) && camera.Set(settings, now) && camera.Trigger(now));
  const auto frame = camera.Poll(later());
  EXPECT_TRUE(frame && *frame);
  return (*frame)->image;
}

FaultEntry CameraFault(FaultKind kind, std::optional<double> angle_deg) {
  FaultEntry entry = MakeFault(kind);
  entry.device = FaultDevice::kCamera;
  entry.angle_deg = angle_deg;
  return entry;
}

}  // namespace turnlight::rig::sim::gige
