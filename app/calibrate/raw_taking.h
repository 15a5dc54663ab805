// Raw captures with a rig of which nothing is known: what `turnlight calibrate capture` does.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "app/calibrate/raw_plan.h"
#include "app/device_config.h"
#include "base/result.h"
#include "base/stop_flag.h"

namespace turnlight::app {

struct RawTaking {
  const StopFlag* stop = nullptr;
  // What is about to move or happen, and what devices note.
  std::function<void(const std::string&)> say = [](const std::string&) {};
};

struct RawTaken {
  rig::RawCapture capture;  // whole, with what other kinds it has
  std::size_t taken = 0;    // now
  std::size_t kept = 0;     // that were there and good
  double full_share = 0.0;  // of the values of the first picture taken now that read full
};

// The capture of a folder, if it has all of the order's pictures, whole: then there is nothing to
// take, and no device is needed.
std::optional<rig::RawCapture> WholeCapture(const rig::CapturePlan& plan, const RawOrder& order,
                                            const std::filesystem::path& out);

// Takes the order's pictures into a folder, going on with what is there: opens the devices, homes
// the table where its position is unknown, turns, proves each arrival and picture, and writes
// capture.json anew after each. What other kinds the folder has stays. Fails (kInput): the folder
// is of other devices or other pictures, or holds something else; (kDevice) with a device's name,
// the motor halted, after the plan's retries; (kInterrupted) on stop. What was taken is kept.
Result<RawTaken> TakeRawCapture(const DeviceConfig& config, const RawOrder& order,
                                const std::filesystem::path& out, const Drivers& drivers,
                                const RawTaking& how);

}  // namespace turnlight::app
