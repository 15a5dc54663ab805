// The drivers that a config may name, one line each. docs/drivers.md shows how to add one.
#pragma once

#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "base/result.h"
#include "base/strict_object.h"
#include "rig/driver.h"
#include "rig/sim/mock_drivers.h"

namespace turnlight::app {

// A driver of real hardware makes its device from its keys, `driver` aside, alone; one whose device
// is in the simulated world takes that too. Nothing is opened. Fails (kInput) with file, line, key
// and what is allowed.
template <typename Device>
using RealDriver = std::function<Result<Device>(StrictObject keys)>;
template <typename Device>
using SimulatedDriver = std::function<Result<Device>(StrictObject keys, rig::sim::SimulatedWorld&)>;

template <typename Device>
struct Driver {
  std::string name;
  std::variant<RealDriver<Device>, SimulatedDriver<Device>> make;

  bool simulated() const { return std::holds_alternative<SimulatedDriver<Device>>(make); }
};

struct Drivers {
  std::vector<Driver<rig::TableDevice>> tables;
  std::vector<Driver<rig::CameraDevice>> cameras;
};

// Those of the program.
const Drivers& BuiltInDrivers();

}  // namespace turnlight::app
