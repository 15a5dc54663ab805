#include "app/drivers.h"

namespace turnlight::app {

const Drivers& BuiltInDrivers() {
  static const Drivers drivers{
      .tables = {{"mock", SimulatedDriver<rig::TableDevice>(rig::MakeMockTable)}},
      .cameras = {{"mock", SimulatedDriver<rig::CameraDevice>(rig::MakeMockCamera)}}};
  return drivers;
}

}  // namespace turnlight::app
