#include "rig/sim/gige/camera_config.h"

#include <arpa/inet.h>

#include <algorithm>
#include <cctype>

#include "base/format.h"
#include "rig/sim/gige/genicam_xml.h"

namespace turnlight::rig::sim::gige {
namespace {

constexpr std::size_t kMaxSerial = 15;  // the register has 16 bytes

bool IsSerial(const std::string& serial) {
  return !serial.empty() && serial.size() <= kMaxSerial &&
         std::all_of(serial.begin(), serial.end(),
                     [](unsigned char c) { return std::isalnum(c) != 0 || c == '-' || c == '_'; });
}

bool IsAddress(const std::string& address) {
  in_addr parsed{};
  return ::inet_pton(AF_INET, address.c_str(), &parsed) == 1;
}

}  // namespace

CameraConfig DefaultCamera(const SimulationConfig& simulation) {
  CameraConfig config;
  config.camera = simulation.camera;
  config.camera.serial = "SIM-CAMERA-1";
  return config;
}

Result<CameraConfig> ReadCamera(StrictObject object, const SimulationConfig& simulation) {
  CameraConfig config = DefaultCamera(simulation);
  ReadField(object, "address", config.address);
  ReadField(object, "serial", config.camera.serial);
  ReadField(object, "readout_ms", config.camera.readout_ms);
  ReadField(object, "first_frame_id", config.camera.first_frame_id);
  config.packet_loss =
      object.OptionalNumber("packet_loss", {.min = 0.0, .max = 0.5}).value_or(config.packet_loss);
  if (const auto name = object.OptionalChoice("pixel_format", PixelFormatNames()))
    config.format = FindPixelFormat(*name);
  if (!IsAddress(config.address)) object.Refuse("address", "an IPv4 address such as \"127.0.0.1\"");
  if (!IsSerial(config.camera.serial))
    object.Refuse("serial", "1 to 15 letters, digits, \"-\" and \"_\"");
  if (Status status = object.Finish(); !status) return Forward(status);
  if (const auto problem = Validate(config.camera))
    return InputError(object.Where(problem->key) + ": " + problem->text);
  const SyntheticCamera& sensor = simulation.camera.scene.camera;
  if (sensor.width % 2 != 0 || sensor.height % 2 != 0)
    return InputError(object.Where("") + ": the scene's camera/size is " +
                      std::to_string(sensor.width) + " x " + std::to_string(sensor.height) +
                      ", allowed are even numbers");
  return config;
}

DeviceIdentity IdentityOf(const CameraConfig& config) {
  return {kVendorName, kModelName, config.camera.serial};
}

RigKnowledge KnowledgeOf(const SimulatedWorld& world, const CameraConfig& config) {
  RigKnowledge known = rig::sim::KnowledgeOf(world);
  const Sensor& sensor = config.camera.scene.sensor;
  known.radiometry = RadiometryOf(world.studio->radiometry, sensor, *config.format);
  known.noise = NoiseOf(sensor, known.radiometry);
  return known;
}

}  // namespace turnlight::rig::sim::gige
