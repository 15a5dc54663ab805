#include "rig/aravis/camera_settings.h"

#include <algorithm>
#include <cmath>

#include "base/format.h"

namespace turnlight::rig::aravis {
namespace {

void Record(Features& features, const std::string& name, SettingsRecord& record) {
  const auto value = features.Word(name);
  record.applied.push_back({name, value ? *value : "unreadable"});
}

std::string Missing(const std::string& what, const std::string& why) {
  return "this camera has no " + what + ": " + why;
}

// A whole number that must be exactly what was asked for.
Status SetExactly(Features& features, const std::string& name, int value, SettingsRecord& record) {
  const std::string asked = name + ": " + std::to_string(value) + " was asked for, the camera ";
  const auto bounds = features.Bounds(name);
  if (!bounds && features.lost()) return Forward(bounds);
  if (bounds && (value < bounds->min || value > bounds->max))
    return DeviceError(asked + "allows " + NumberText(bounds->min) + " to " +
                       NumberText(bounds->max));
  if (Status set = features.SetNumber(name, value); !set) return set;
  const auto now = features.Integer(name);
  if (!now) return Forward(now);
  if (*now != value)
    return DeviceError(asked + "has " + std::to_string(*now) + ", the next of its steps");
  record.applied.push_back({name, std::to_string(value)});
  return {};
}

Status ApplyPixelFormat(Features& features, const PixelFormat& format, SettingsRecord& record) {
  const std::string name = "PixelFormat";
  if (!features.Has(name)) return DeviceError(Missing(name, "it cannot be told how to send"));
  // By the code, as the names of older cameras differ (RGB8Packed).
  if (Status set = features.SetNumber(name, format.code); !set)
    return DeviceError(set.error().text + "; " + format.name + " was asked for, the camera has " +
                       Listed(features.Words(name)));
  const auto now = features.Integer(name);
  if (!now || *now != static_cast<std::int64_t>(format.code))
    return DeviceError(name + ": " + format.name + " was asked for, the camera has " +
                       Listed(features.Words(name)));
  Record(features, name, record);
  return {};
}

Status ApplyBinning(Features& features, const AravisConfig& config, SettingsRecord& record) {
  const char* names[] = {"BinningHorizontal", "BinningVertical"};
  const char* decimations[] = {"DecimationHorizontal", "DecimationVertical"};
  for (std::size_t i = 0; i < 2; ++i) {
    if (features.Has(decimations[i]))
      if (Status set = SetExactly(features, decimations[i], 1, record); !set) return set;
    if (features.Has(names[i])) {
      if (Status set = SetExactly(features, names[i], config.binning[i], record); !set) return set;
    } else if (config.binning[i] != 1) {
      return DeviceError(Missing(names[i], "binning cannot be set"));
    }
  }
  return {};
}

// The region is moved to the corner first, so that every size fits.
Status ApplyRegion(Features& features, const AravisConfig& config, SettingsRecord& record) {
  const char* offsets[] = {"OffsetX", "OffsetY"};
  const int sides[] = {config.size.width, config.size.height};
  for (const char* name : offsets)
    if (features.Has(name))
      if (Status set = features.SetNumber(name, 0.0); !set && features.lost()) return set;
  if (Status set = ApplyBinning(features, config, record); !set) return set;
  const char* names[] = {"Width", "Height"};
  for (std::size_t i = 0; i < 2; ++i) {
    if (!features.Has(names[i]))
      return DeviceError(Missing(names[i], "its pictures' size is open"));
    if (Status set = SetExactly(features, names[i], sides[i], record); !set) return set;
  }
  for (std::size_t i = 0; i < 2; ++i) {
    if (features.Has(offsets[i])) {
      if (Status set = SetExactly(features, offsets[i], config.offset[i], record); !set) return set;
    } else if (config.offset[i] != 0) {
      return DeviceError(Missing(offsets[i], "the region of interest cannot be moved"));
    }
  }
  return {};
}

// What would change pictures from one to the next, or bend their values.
Status ApplyOffs(Features& features, SettingsRecord& record) {
  const std::initializer_list<const char*> offs[] = {
      {"ExposureAuto"},
      {"GainAuto"},
      {"BlackLevelAuto"},
      {"BalanceWhiteAuto"},
      {"GammaEnable", "GammaEnabled"},
      {"LUTEnable"},
      {"TestPattern"},
      {"AcquisitionFrameRateEnable", "AcquisitionFrameRateEnabled"}};
  for (const auto& spellings : offs) {
    const std::string name = features.FirstOf(spellings);
    if (name.empty()) {
      record.missing.push_back(*spellings.begin());
      continue;
    }
    if (Status set = features.SwitchOff(name); !set) return set;
    Record(features, name, record);
  }
  // Some have no switch but the exponent alone; behind a switch it may not be written any more.
  if (features.FirstOf({"GammaEnable", "GammaEnabled"}).empty() && features.Has("Gamma")) {
    if (Status set = features.SetNumber("Gamma", 1.0); !set) return set;
    const auto now = features.Number("Gamma");
    if (!now) return Forward(now);
    if (std::abs(*now - 1.0) > 1e-3)
      return DeviceError("Gamma: 1 was asked for, the camera has " + NumberText(*now));
    Record(features, "Gamma", record);
  }
  if (features.Has("ExposureMode") && features.Allows("ExposureMode", "Timed")) {
    if (Status set = features.SetWord("ExposureMode", "Timed"); !set) return set;
    Record(features, "ExposureMode", record);
  }
  return {};
}

Status ApplyBlackLevel(Features& features, const AravisConfig& config, SettingsRecord& record) {
  const std::string name = features.FirstOf({"BlackLevel", "BlackLevelRaw", "BlackLevelAbs"});
  if (name.empty()) {
    if (config.black_level) return DeviceError(Missing("BlackLevel", "black_level cannot be set"));
    record.missing.push_back("BlackLevel");
    return {};
  }
  if (config.black_level) {
    if (Status set = features.SetNumber(name, *config.black_level); !set) return set;
    const auto now = features.Number(name);
    if (!now) return Forward(now);
    // Half a step of a whole number, a thousandth of what is not.
    const double allowed =
        features.IsFloat(name) ? std::max(0.01, 1e-3 * std::abs(*config.black_level)) : 0.5;
    if (std::abs(*now - *config.black_level) > allowed)
      return DeviceError(name + ": " + NumberText(*config.black_level) +
                         " was asked for, the camera has " + NumberText(*now));
  }
  Record(features, name, record);
  return {};
}

// One picture for each command. Every other kind of trigger is off.
Status ApplyTrigger(Features& features, SettingsRecord& record) {
  if (!features.Exists("TriggerMode") || !features.Exists("TriggerSource") ||
      !features.Exists(kTriggerCommand))
    return DeviceError(Missing("software trigger (TriggerMode, TriggerSource, TriggerSoftware)",
                               "its pictures could not be bound to an angle"));
  std::string selected;
  if (features.Has("TriggerSelector")) {
    const auto words = features.Words("TriggerSelector");
    for (const char* word : {"FrameStart", "ExposureStart", "FrameBurstStart", "AcquisitionStart"})
      if (selected.empty() && std::find(words.begin(), words.end(), word) != words.end())
        selected = word;
    if (selected.empty())
      return DeviceError("TriggerSelector: the camera has " + Listed(words) +
                         ", needed is FrameStart, ExposureStart, FrameBurstStart or "
                         "AcquisitionStart");
    for (const std::string& word : words) {
      if (word == selected || !features.SetWord("TriggerSelector", word)) continue;
      if (features.Has("TriggerMode"))
        if (Status off = features.SwitchOff("TriggerMode"); !off) return off;
    }
    if (Status set = features.SetWord("TriggerSelector", selected); !set) return set;
  }
  const bool burst = selected == "FrameBurstStart" || selected == "AcquisitionStart";
  if (burst) {
    const std::string count =
        features.FirstOf({"AcquisitionBurstFrameCount", "AcquisitionFrameCount"});
    if (count.empty())
      return DeviceError("a trigger of this camera (" + selected +
                         ") begins an endless run of pictures, and it has no "
                         "AcquisitionBurstFrameCount to end it after one");
    if (Status set = SetExactly(features, count, 1, record); !set) return set;
  }
  if (Status set = features.SetWord("TriggerMode", "On"); !set) return set;
  if (!features.Allows("TriggerSource", "Software"))
    return DeviceError("TriggerSource: the camera has " + Listed(features.Words("TriggerSource")) +
                       ", needed is Software");
  if (Status set = features.SetWord("TriggerSource", "Software"); !set) return set;
  for (const char* name : {"TriggerSelector", "TriggerMode", "TriggerSource"})
    if (features.Has(name)) Record(features, name, record);
  const std::string delay = features.FirstOf({"TriggerDelay", "TriggerDelayAbs"});
  if (delay.empty()) return {};
  const auto bounds = features.Bounds(delay);
  Status set = bounds ? features.SetNumber(delay, bounds->min) : Forward(bounds);
  if (!set) return set;
  Record(features, delay, record);
  return {};
}

Status ApplyAcquisition(Features& features, SettingsRecord& record) {
  for (const char* name : {"AcquisitionStart", "AcquisitionStop", "PayloadSize"})
    if (!features.Has(name)) return DeviceError(Missing(name, "it cannot stream"));
  if (!features.Has("AcquisitionMode")) {
    record.missing.push_back("AcquisitionMode");
    return {};
  }
  if (Status set = features.SetWord("AcquisitionMode", "Continuous"); !set) return set;
  Record(features, "AcquisitionMode", record);
  return {};
}

// Raw numbers have no unit that all makers agree on: 0 dB is the smallest.
Status FindRawGain(Features& features, const AravisConfig& config, ExposureControl& control,
                   SettingsRecord& record) {
  control.db_per_unit = config.gain_raw_step_db.value_or(0.0);
  const auto bounds = features.Bounds(control.gain);
  if (!bounds) return Forward(bounds);
  control.gain_at_zero_db = bounds->min;
  record.notes.push_back(
      control.gain + " is not in dB; 0 dB means its smallest value, " + NumberText(bounds->min) +
      (config.gain_raw_step_db ? "" : ", and other gains need gain_raw_step_db in the config"));
  return {};
}

}  // namespace

Status ApplySettings(Features& features, const AravisConfig& config, SettingsRecord& record) {
  // A client that died may have left it streaming, with all of this locked.
  if (Status stop = features.Execute("AcquisitionStop"); !stop && features.lost()) return stop;
  Status status = ApplyPixelFormat(features, config.format, record);
  if (status) status = ApplyRegion(features, config, record);
  if (status) status = ApplyAcquisition(features, record);
  if (status) status = ApplyTrigger(features, record);
  if (status) status = ApplyOffs(features, record);
  if (status) status = ApplyBlackLevel(features, config, record);
  return status;
}

Result<ExposureControl> FindExposureControl(Features& features, const AravisConfig& config,
                                            SettingsRecord& record) {
  ExposureControl control;
  control.exposure = features.FirstOf({"ExposureTime", "ExposureTimeAbs", "ExposureTimeRaw"});
  if (control.exposure.empty())
    return DeviceError(Missing("ExposureTime", "its exposure cannot be set"));
  if (control.exposure == "ExposureTimeRaw") {
    const std::string base = features.FirstOf({"ExposureTimeBaseAbs"});
    if (!base.empty()) {
      const auto us = features.Number(base);
      if (!us) return Forward(us);
      control.us_per_unit = *us > 0.0 ? *us : 1.0;
    } else {
      record.notes.push_back("ExposureTimeRaw is taken as microseconds: the camera names no base");
    }
  }
  control.gain = features.FirstOf({"Gain", "GainAbs", "GainRaw"});
  if (control.gain.empty()) {
    record.missing.push_back("Gain");
  } else if (const std::string unit = features.Unit(control.gain);
             control.gain == "GainRaw" || !features.IsFloat(control.gain) ||
             (!unit.empty() && unit != "dB")) {
    if (Status found = FindRawGain(features, config, control, record); !found)
      return Forward(found);
  }
  return control;
}

Result<CameraSettings> ReadExposure(Features& features, const ExposureControl& control) {
  const auto exposure = features.Number(control.exposure);
  if (!exposure) return Forward(exposure);
  CameraSettings settings{*exposure * control.us_per_unit, 0.0};
  if (control.gain.empty()) return settings;
  const auto gain = features.Number(control.gain);
  if (!gain) return Forward(gain);
  if (control.db_per_unit == 0.0 && *gain != control.gain_at_zero_db)
    return DeviceError(control.gain + ": the camera has " + NumberText(*gain) + ", 0 dB is " +
                       NumberText(control.gain_at_zero_db));
  settings.gain_db = (*gain - control.gain_at_zero_db) * control.db_per_unit;
  return settings;
}

Result<CameraSettings> SetExposure(Features& features, const ExposureControl& control,
                                   const CameraSettings& settings) {
  const auto set = [&](const std::string& name, double value) -> Status {
    const auto bounds = features.Bounds(name);
    if (!bounds && features.lost()) return Forward(bounds);
    if (bounds && bounds->min <= bounds->max) value = std::clamp(value, bounds->min, bounds->max);
    return features.SetNumber(name, value);
  };
  if (!(settings.exposure_us > 0.0) || !std::isfinite(settings.exposure_us) ||
      !std::isfinite(settings.gain_db))
    return DeviceError("exposure " + NumberText(settings.exposure_us) + " us, gain " +
                       NumberText(settings.gain_db) +
                       " dB, allowed are finite numbers and an exposure above 0");
  if ((control.gain.empty() || control.db_per_unit == 0.0) && settings.gain_db != 0.0)
    return DeviceError("a gain of " + NumberText(settings.gain_db) + " dB was asked for, " +
                       (control.gain.empty()
                            ? "the camera has no gain"
                            : control.gain + " is not in dB: give gain_raw_step_db in the config"));
  if (Status done = set(control.exposure, settings.exposure_us / control.us_per_unit); !done)
    return Forward(done);
  if (!control.gain.empty()) {
    const double units = control.db_per_unit == 0.0 ? 0.0 : settings.gain_db / control.db_per_unit;
    if (Status done = set(control.gain, control.gain_at_zero_db + units); !done)
      return Forward(done);
  }
  return ReadExposure(features, control);
}

}  // namespace turnlight::rig::aravis
