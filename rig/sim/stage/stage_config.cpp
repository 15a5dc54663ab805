#include "rig/sim/stage/stage_config.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <string>
#include <utility>

namespace turnlight::rig::sim::stage {
namespace {

constexpr double kMaxDeg = 36000.0;
constexpr std::size_t kMaxStartup = 79;

bool IsNumber(const std::string& text, std::size_t most) {
  return !text.empty() && text.size() <= most && std::all_of(text.begin(), text.end(), [](char c) {
    return std::isdigit(static_cast<unsigned char>(c));
  });
}

void ReadSettings(StrictObject& object, const StageConfig& config, GrblConfig& grbl) {
  const nlohmann::json& list = object.Raw("settings");
  if (list.is_null()) return;
  const bool hal = grbl.axis == 'A';
  const GrblSettings known(config.table, hal ? "XYZA" : "XYZ", hal ? 3 : 0, {});
  bool good = list.is_object();
  if (good) {
    for (const auto& [key, value] : list.items()) {
      const int number = IsNumber(key, 3) ? std::atoi(key.c_str()) : -1;
      // Rates and steps are divided by.
      const bool divisor = number >= 100 && number < 130;
      good = good && known.Has(number) && value.is_number() && value.get<double>() >= 0.0 &&
             value.get<double>() < 1e9 && !(divisor && value.get<double>() == 0.0);
      if (good) grbl.settings[number] = value.get<double>();
    }
  }
  if (!good)
    object.Refuse("settings",
                  "numbers of settings that GRBL has and what they are, such as {22: 1, 130: 720}");
}

void ReadStartup(StrictObject& object, GrblConfig& grbl) {
  const nlohmann::json& list = object.Raw("startup");
  if (list.is_null()) return;
  bool good = list.is_array() && list.size() == grbl.startup.size();
  for (std::size_t i = 0; good && i < grbl.startup.size(); ++i) {
    good = list[i].is_string() && list[i].get<std::string>().size() <= kMaxStartup;
    if (good) grbl.startup[i] = list[i].get<std::string>();
  }
  if (!good) object.Refuse("startup", "a list of two blocks of at most 79 characters");
}

GrblConfig ReadGrbl(StrictObject& object, StageConfig& config) {
  if (object.Has("feedback"))
    object.RefuseText("feedback", "GRBL has no encoder, allowed is to leave this key out");
  config.table.feedback = TableFeedback::kOpenLoop;
  config.reset_on_open = object.OptionalBoolean("reset_on_open").value_or(true);
  GrblConfig grbl;
  grbl.settings[22] = 1.0;
  if (object.OptionalChoice("axis", {"X", "A"}) == "A") grbl.axis = 'A';
  grbl.build_info = object.OptionalString("build_info").value_or("");
  ReadSettings(object, config, grbl);
  ReadStartup(object, grbl);
  return grbl;
}

void ReadTravel(StrictObject& object, double& min_deg, double& max_deg) {
  min_deg = object.OptionalNumber("min_deg", {.min = -kMaxDeg, .max = 0.0}).value_or(min_deg);
  max_deg = object.OptionalNumber("max_deg", {.min = 0.0, .max = kMaxDeg}).value_or(max_deg);
}

ZaberConfig ReadZaber(StrictObject& object, const StageConfig& config) {
  if (!IsNumber(config.table.serial, 9))
    object.Refuse("serial", "a number of at most 9 digits, as a Zaber's is");
  ZaberConfig zaber;
  zaber.device = static_cast<int>(object.OptionalInteger("device", 1, 99).value_or(zaber.device));
  zaber.checksum = object.OptionalBoolean("checksum").value_or(zaber.checksum);
  ReadTravel(object, zaber.min_deg, zaber.max_deg);
  return zaber;
}

Smc100Config ReadSmc100(StrictObject& object) {
  Smc100Config smc100;
  smc100.address =
      static_cast<int>(object.OptionalInteger("address", 1, 31).value_or(smc100.address));
  ReadTravel(object, smc100.min_deg, smc100.max_deg);
  return smc100;
}

}  // namespace

Result<StageConfig> ReadStageConfig(StrictObject object, const MockTurntableConfig& world) {
  StageConfig config;
  config.table = world;
  const std::string firmware = object.Choice("firmware", {"grbl", "zaber", "smc100"});
  if (firmware == "zaber") config.table.serial = "54321";
  ReadTableKeys(object, config.table);
  config.link = object.String("link");
  if (object.ok() && (config.link.empty() || !config.link.has_filename()))
    object.Refuse("link", "the path of a symbolic link, such as /tmp/turnlight_stage");
  const int usual_baud = firmware == "smc100" ? 57600 : 115200;
  config.baud = static_cast<int>(object.OptionalInteger("baud", 0, 4000000).value_or(usual_baud));
  if (config.baud > 0 && config.baud < 300) object.Refuse("baud", "0 or 300 to 4000000");
  if (firmware == "grbl") config.firmware = ReadGrbl(object, config);
  if (firmware == "zaber") config.firmware = ReadZaber(object, config);
  if (firmware == "smc100") config.firmware = ReadSmc100(object);
  if (Status status = object.Finish(); !status) return Forward(status);
  if (const auto problem = Validate(config.table))
    return InputError(object.Where(problem->key) + ": " + problem->text);
  return config;
}

}  // namespace turnlight::rig::sim::stage
