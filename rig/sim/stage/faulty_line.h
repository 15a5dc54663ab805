// The wire from a controller to its host with the faults of rig/sim/fault_script.h: what comes out
// of it, and when. It knows no port.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rig/sim/fault_script.h"
#include "rig/sim/mock_turntable.h"
#include "rig/sim/stage/stage_firmware.h"

namespace turnlight::rig::sim::stage {

class FaultyLine {
 public:
  // faults may be null. The table tells which angle is commanded.
  FaultyLine(std::shared_ptr<FaultScript> faults, std::shared_ptr<const MockTurntable> table);

  void Send(const FirmwareMessage& message, DeviceTime now);
  // What has come out by now, in order.
  std::string Take(DeviceTime now);
  // What is on its way is lost.
  void Clear();
  // The controller hangs: it neither reads nor answers.
  bool IsSilent(DeviceTime now);

 private:
  struct Chunk {
    DeviceTime due{};
    std::string bytes;
  };
  std::optional<FaultEntry> Strike(FaultKind kind, DeviceTime now);
  void Put(DeviceTime due, std::string bytes);
  std::string Garbage(std::size_t bytes);
  void Alter(std::string& line);
  std::uint64_t Draw(std::uint64_t below);

  const std::shared_ptr<FaultScript> faults_;
  const std::shared_ptr<const MockTurntable> table_;
  std::vector<Chunk> chunks_;  // in order of their times
  DeviceTime free_at_{};       // a split line has come out
  DeviceTime silent_until_{};
  std::uint64_t drawn_ = 0;
};

}  // namespace turnlight::rig::sim::stage
