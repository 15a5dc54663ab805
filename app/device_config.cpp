#include "app/device_config.h"

#include <utility>

#include "app/driver_choice.h"
#include "app/rig_config.h"
#include "app/run_config.h"
#include "base/file.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxConfigBytes = std::uint64_t{16} << 20;

Status ReadSections(StrictObject& root, DeviceConfig& config) {
  root.Ignore("name");
  config.has_graph = root.Has("graph");
  root.Ignore("graph");
  const auto capture = root.OptionalObject("capture");
  const auto simulation = root.OptionalObject("simulation");
  StrictObject rig = root.Object("rig");
  if (Status status = root.Finish(); !status) return status;
  config.table = rig.OptionalObject("table");
  config.camera = rig.OptionalObject("camera");
  for (const char* key : {"calibration", "target", "length_unit"}) rig.Ignore(key);
  if (Status status = rig.Finish(); !status) return status;
  config.has_capture = capture.has_value();
  if (capture) {
    auto plan = rig::ParseCapturePlan(*capture);
    if (!plan) return Forward(plan);
    config.plan = std::move(*plan);
  }
  if (!simulation) return {};
  auto read = rig::sim::ReadSimulation(*simulation, AnglesOf(config.plan));
  if (!read) return Forward(read);
  config.simulation = std::move(*read);
  return {};
}

// A section that a command needs, with a driver of the table.
template <typename Device>
Result<Device> MakeDevice(const DeviceConfig& config, const std::optional<StrictObject>& section,
                          const char* name, const std::vector<Driver<Device>>& drivers,
                          Devices& devices) {
  if (!section)
    return InputError(config.file + ": rig/" + name +
                      ": this key is missing, and this command needs it, as in\n" + kRigExample);
  StrictObject keys = *section;
  const Driver<Device>* driver = FindDriver(drivers, keys);
  if (!driver) return Forward(keys.Finish());
  if (driver->simulated() && !devices.world) {
    if (!config.simulation)
      return InputError(keys.Where("driver") + ": " + driver->name +
                        " needs the section simulation beside rig, as in\n" + kRigExample);
    auto world = rig::sim::BuildWorld(*config.simulation);
    if (!world) return Forward(world);
    devices.world = std::move(*world);
  }
  return Make(*driver, keys, devices.world ? &*devices.world : nullptr);
}

// Whether the camera is simulated, and so photographs the table of its world.
bool NeedsTable(const DeviceConfig& config, const Drivers& drivers) {
  if (!config.camera || !config.table) return false;
  StrictObject keys = *config.camera;
  const auto* driver = FindDriver(drivers.cameras, keys);
  return driver && driver->simulated();
}

std::string NameOf(const std::optional<StrictObject>& section) {
  const std::string driver = TextOf(section, "driver");
  for (const char* key : {"port", "id"})
    if (const std::string text = TextOf(section, key); !text.empty())
      return driver + (std::string(key) == "port" ? " at " : " ") + text;
  const std::string serial = TextOf(section, "usb_serial");
  return serial.empty() ? driver : driver + " at the adapter " + serial;
}

}  // namespace

Result<DeviceConfig> ReadDeviceConfig(const fs::path& path) {
  const auto text = ReadTypedFile(path, kMaxConfigBytes);
  if (!text) return Forward(text);
  return ParseDeviceConfig(*text, path);
}

Result<DeviceConfig> ParseDeviceConfig(const std::string& text, const fs::path& path) {
  auto parsed = ParseYaml(text, path.string());
  if (!parsed) return Forward(parsed);
  DeviceConfig config;
  config.file = path.string();
  config.folder = path.parent_path();
  config.document = std::make_shared<const Document>(std::move(*parsed));
  StrictObject root(*config.document);
  if (const Status status = ReadSections(root, config); !status) return Forward(status);
  return config;
}

Result<Devices> MakeDevices(const DeviceConfig& config, WantedDevices wanted,
                            const Drivers& drivers) {
  Devices devices;
  if (wanted.table || (wanted.camera && NeedsTable(config, drivers))) {
    auto table = MakeDevice(config, config.table, "table", drivers.tables, devices);
    if (!table) return Forward(table);
    devices.table = std::move(*table);
  }
  if (wanted.camera) {
    auto camera = MakeDevice(config, config.camera, "camera", drivers.cameras, devices);
    if (!camera) return Forward(camera);
    devices.camera = std::move(*camera);
  }
  return devices;
}

std::string TextOf(const std::optional<StrictObject>& section, const std::string& key) {
  if (!section) return "";
  StrictObject keys = *section;
  const nlohmann::json& value = keys.Raw(key);
  return value.is_string() ? value.get<std::string>() : "";
}

std::string NameOfTable(const DeviceConfig& config) { return NameOf(config.table); }
std::string NameOfCamera(const DeviceConfig& config) { return NameOf(config.camera); }

Result<std::optional<rig::RigCalibration>> ReadCalibrationOf(const DeviceConfig& config) {
  StrictObject rig = StrictObject(*config.document).Object("rig");
  auto read = ReadRigCalibrationKey(rig, config.folder);
  if (!read) return Forward(read);
  return std::move(read->calibration);
}

calib::Radiometry NominalLevels(const rig::CameraDevice& camera) {
  calib::Radiometry levels;
  const int depth = camera.format.depth;
  levels.white = camera.full_scale_dn ? camera.full_scale_dn->back()
                 : depth == CV_8U     ? 255.0
                 : depth == CV_16U    ? 65535.0
                                      : 1.0;
  return levels;
}

calib::Radiometry LevelsOf(const Devices& devices,
                           const std::optional<rig::RigCalibration>& calibration) {
  if (calibration) return calibration->radiometry;
  if (devices.world) return rig::sim::KnowledgeOf(*devices.world).radiometry;
  return NominalLevels(*devices.camera);
}

}  // namespace turnlight::app
