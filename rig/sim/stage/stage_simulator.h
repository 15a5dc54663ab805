// A simulated stage on a pseudo-terminal: a thread that runs a firmware (stage_firmware.h) at the
// pace of a serial line, under a fixed link. Times of its table are since the epoch that it is
// given, so that a simulated camera can ask for the true angle of any instant.
//
// - Bytes come and go at the rate of the baud, ten bits each; what a host does not read is lost
// past
//   64 KiB, what comes while the port is closed is lost, what a host wrote before it closed is
//   read.
// - Opening the port by its first client resets the board if the config says so.
// - The fault `unplugged` hangs up: the link is gone, whoever has the port open sees the end of it;
//   later another pseudo-terminal is under the link. A GRBL is fed by USB: it stops and starts
//   anew. The others have a supply of their own and go on.
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "base/lock_file.h"
#include "base/result.h"
#include "rig/sim/mock_drivers.h"
#include "rig/sim/stage/faulty_line.h"
#include "rig/sim/stage/pseudo_terminal.h"
#include "rig/sim/stage/stage_config.h"

namespace turnlight::rig::sim::stage {

using SimulatorEpoch = std::chrono::steady_clock::time_point;

class StageSimulator {
 public:
  // Opens the port and begins; the link is there when it returns. faults may be null. Fails: the
  // link's name is taken by something else or by another simulator (kInput), or the system says no.
  static Result<std::unique_ptr<StageSimulator>> Start(const StageConfig& config,
                                                       std::shared_ptr<FaultScript> faults,
                                                       SimulatorEpoch epoch);
  // Hangs up, and takes the link away.
  ~StageSimulator();

  const std::shared_ptr<MockTurntable>& table() const { return table_; }
  // Where the link points now; empty while it is unplugged.
  std::string port() const;

 private:
  StageSimulator(const StageConfig& config, std::shared_ptr<FaultScript> faults,
                 SimulatorEpoch epoch, LockFile lock);

  Status Plug(DeviceTime now);
  void Unplug(DeviceTime now, double for_ms);
  void Run();
  void Step();
  void WatchClient(DeviceTime now);
  void ReadInput(DeviceTime now);
  void WriteOutput(DeviceTime now);
  // How many bytes the line carries until now; from: when it is free.
  std::size_t Budget(DeviceTime& from, DeviceTime now) const;
  DeviceTime Now() const;

  const StageConfig config_;
  const std::shared_ptr<FaultScript> faults_;
  const SimulatorEpoch epoch_;
  LockFile lock_;
  const std::shared_ptr<MockTurntable> table_;
  const std::unique_ptr<StageFirmware> firmware_;

  // Of the thread, once it runs.
  FaultyLine line_;
  std::optional<PseudoTerminal> terminal_;
  std::string last_name_;
  DeviceTime plugged_at_{};  // when it comes back
  bool has_client_ = false;
  std::string output_;
  DeviceTime input_free_{}, output_free_{};

  mutable std::mutex mutex_;
  std::string port_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

// Of a config's `devices/table`: makes the world's table and starts its controller with the world's
// faults. Messages name file, line, key and what is allowed.
Result<std::unique_ptr<StageSimulator>> StartStage(StrictObject object, SimulatedWorld& world,
                                                   SimulatorEpoch epoch);

}  // namespace turnlight::rig::sim::stage
