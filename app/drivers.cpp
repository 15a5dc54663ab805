#include "app/drivers.h"

#include "rig/aravis/aravis_camera.h"
#include "rig/serial/serial_drivers.h"

namespace turnlight::app {

const Drivers& BuiltInDrivers() {
  static const Drivers kDrivers{
      .tables = {{"mock", SimulatedDriver<rig::TableDevice>(rig::sim::MakeMockTable)},
                 {"grbl", RealDriver<rig::TableDevice>(rig::serial::MakeGrblTable)},
                 {"zaber", RealDriver<rig::TableDevice>(rig::serial::MakeZaberTable)},
                 {"smc100", RealDriver<rig::TableDevice>(rig::serial::MakeSmc100Table)}},
      .cameras = {{"mock", SimulatedDriver<rig::CameraDevice>(rig::sim::MakeMockCamera)},
                  {"aravis", RealDriver<rig::CameraDevice>(rig::aravis::MakeAravisCamera)}}};
  return kDrivers;
}

}  // namespace turnlight::app
