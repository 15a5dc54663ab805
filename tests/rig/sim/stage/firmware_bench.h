// A firmware under test, the table that it drives and the time that they live in. No port.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "rig/sim/mock_turntable.h"
#include "rig/sim/stage/stage_firmware.h"

namespace turnlight::rig::sim::stage {

inline MockTurntableConfig RigidTable(TableFeedback feedback) {
  MockTurntableConfig config;
  config.serial = "54321";
  config.backlash_deg = 0.0;
  config.settle_amplitude_deg = 0.0;
  config.max_speed_deg_s = 60.0;
  config.acceleration_deg_s2 = 240.0;
  config.feedback = feedback;
  return config;
}

inline FaultEntry AtAngle(FaultKind kind, double angle_deg) {
  FaultEntry entry = MakeFault(kind);
  entry.angle_deg = angle_deg;
  return entry;
}

class FirmwareBench {
 public:
  template <typename Firmware, typename Config>
  static FirmwareBench Of(const Config& config, const MockTurntableConfig& table_config,
                          std::vector<FaultEntry> entries = {}) {
    FirmwareBench bench;
    bench.table = std::make_shared<MockTurntable>(
        table_config, std::make_shared<FaultScript>(std::move(entries)));
    bench.firmware = std::make_unique<Firmware>(config, bench.table);
    bench.firmware->PowerOn(bench.now);
    return bench;
  }

  // What it says to these bytes at once.
  std::string Ask(const std::string& bytes) {
    firmware->Receive(bytes, now);
    return Said();
  }
  // What it says while so much time passes.
  std::string Wait(int ms) {
    std::string said;
    for (int i = 0; i < ms; ++i) {
      now += std::chrono::milliseconds(1);
      firmware->Pass(now);
      said += Said();
    }
    return said;
  }
  std::string Said() {
    std::string said;
    for (const FirmwareMessage& message : firmware->TakeMessages()) said += message.bytes;
    return said;
  }
  double True() const { return table->TrueAngleDeg(now); }

  std::shared_ptr<MockTurntable> table;
  std::unique_ptr<StageFirmware> firmware;
  DeviceTime now{std::chrono::seconds(1)};
};

}  // namespace turnlight::rig::sim::stage
