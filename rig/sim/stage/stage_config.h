// `devices/table` of a simulator's config: which controller it is, where its port is, and what its
// table is like.
//
// Keys:
//   firmware   grbl, zaber or smc100; required
//   link       the port's fixed name, a symbolic link that the simulator makes; required
//   baud       at which bytes come and go; 115200 (smc100: 57600); 0: at once
// those of the device in rig/sim/mock_config.h (serial, max_speed_deg_s, ..., feedback; GRBL has no
// encoder; a Zaber's serial is a number), and the firmware's own:
//   grbl    axis: X        X, or A of a grblHAL
//           reset_on_open: true    opening the port resets it, as most Arduinos
//           settings: {22: 1, 130: 720}    by number; $22 is 1 unless said, others the usual ones
//           build_info: ""
//           startup: ["", ""]      $N0 and $N1
//   zaber   device: 1, checksum: false, min_deg: -36000, max_deg: 36000
//   smc100  address: 1, min_deg: -360, max_deg: 360
#pragma once

#include <filesystem>
#include <variant>

#include "base/result.h"
#include "base/strict_object.h"
#include "rig/sim/mock_config.h"
#include "rig/sim/stage/grbl_firmware.h"
#include "rig/sim/stage/smc100_firmware.h"
#include "rig/sim/stage/zaber_firmware.h"

namespace turnlight::rig::sim::stage {

struct StageConfig {
  std::variant<GrblConfig, ZaberConfig, Smc100Config> firmware;
  std::filesystem::path link;
  int baud = 115200;  // 0, or 300..4000000
  bool reset_on_open = false;
  MockTurntableConfig table;
};

// world: what the config says of the table under `table`. Messages name file, line, key and what is
// allowed.
Result<StageConfig> ReadStageConfig(StrictObject object, const MockTurntableConfig& world);

}  // namespace turnlight::rig::sim::stage
