// What a camera is set to: once, when it is opened, all that makes its pictures linear and
// repeatable; then exposure and gain, for every picture. Everything is read back.
//
// Standard names (SFNC) with their older spellings. A camera that lacks what is needed is refused
// with a reason; what it may lack is gathered for one line of the log.
#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "rig/aravis/aravis_config.h"
#include "rig/aravis/features.h"
#include "rig/device.h"

namespace turnlight::rig::aravis {

struct AppliedSetting {
  std::string feature;
  std::string value;  // as read back
};

struct SettingsRecord {
  std::vector<AppliedSetting> applied;
  std::vector<std::string> missing;  // optional ones that the camera does not have
  std::vector<std::string> notes;
};

// Pixel format, region, binning; autos, gamma, tables and frame-rate limits off; black level; a
// software trigger for single frames. Fails (kDevice).
Status ApplySettings(Features& features, const AravisConfig& config, SettingsRecord& record);

// How this camera takes exposure and gain.
struct ExposureControl {
  std::string exposure;      // feature
  double us_per_unit = 1.0;  // of it
  std::string gain;          // feature; empty: it has none
  double db_per_unit = 1.0;  // 0: unknown, only 0 dB can be set
  double gain_at_zero_db = 0.0;
};
Result<ExposureControl> FindExposureControl(Features& features, const AravisConfig& config,
                                            SettingsRecord& record);

// Within the camera's bounds and steps; returns what it has then.
Result<CameraSettings> SetExposure(Features& features, const ExposureControl& control,
                                   const CameraSettings& settings);
Result<CameraSettings> ReadExposure(Features& features, const ExposureControl& control);

// The command of a software trigger, as ApplySettings found it.
inline constexpr char kTriggerCommand[] = "TriggerSoftware";

}  // namespace turnlight::rig::aravis
