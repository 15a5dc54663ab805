// A driver out of the table by a section's key `driver`, and its device made.
#pragma once

#include <algorithm>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "app/drivers.h"

namespace turnlight::app {

// Marks the key as read. Null: there is no such driver, and keys.Finish() says so.
template <typename Device>
const Driver<Device>* FindDriver(const std::vector<Driver<Device>>& drivers, StrictObject& keys) {
  std::vector<std::string> names;
  for (const Driver<Device>& driver : drivers) names.push_back(driver.name);
  const std::string name = keys.Choice("driver", names);
  const auto found =
      std::find_if(drivers.begin(), drivers.end(),
                   [&](const Driver<Device>& driver) { return driver.name == name; });
  return keys.ok() ? &*found : nullptr;
}

// world: there is one if the driver is simulated. A camera's section has the key lens, whatever its
// driver: a note, which a calibration's must be.
template <typename Device>
Result<Device> Make(const Driver<Device>& driver, StrictObject keys,
                    rig::sim::SimulatedWorld* world) {
  std::string lens;
  if constexpr (std::is_same_v<Device, rig::CameraDevice>)
    lens = keys.OptionalString("lens").value_or("");
  auto device = driver.simulated() ? std::get<SimulatedDriver<Device>>(driver.make)(keys, *world)
                                   : std::get<RealDriver<Device>>(driver.make)(keys);
  if constexpr (std::is_same_v<Device, rig::CameraDevice>)
    if (device) device->lens = lens;
  return device;
}

}  // namespace turnlight::app
