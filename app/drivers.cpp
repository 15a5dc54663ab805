#include "app/drivers.h"

namespace turnlight::app {

const Drivers& BuiltInDrivers() {
  static const Drivers kDrivers{
      .tables = {{"mock", SimulatedDriver<rig::TableDevice>(rig::sim::MakeMockTable)}},
      .cameras = {{"mock", SimulatedDriver<rig::CameraDevice>(rig::sim::MakeMockCamera)}}};
  return kDrivers;
}

}  // namespace turnlight::app
