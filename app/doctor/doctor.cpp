#include "app/doctor/doctor.h"

#include "app/doctor/computer_checks.h"
#include "app/doctor/device_checks.h"
#include "app/doctor/network_checks.h"
#include "app/doctor/port_checks.h"
#include "app/doctor/trial_checks.h"

namespace turnlight::app {
namespace {

struct ListedCheck {
  const char* name;
  Check (*run)(Patient&);
};

// What is opened comes after who holds it; what moves comes last.
constexpr ListedCheck kChecks[] = {
    {"config", CheckRunConfig},
    {"port permissions", CheckPortAccess},
    {"port holder", CheckPortHolder},
    {"port name", CheckPortName},
    {"controller", CheckController},
    {"position", CheckPosition},
    {"camera seen", CheckCameraSeen},
    {"USB permissions", CheckUsbAccess},
    {"USB memory", CheckUsbMemory},
    {"camera", CheckCamera},
    {"exposure and gain", CheckExposure},
    {"socket buffer", CheckSocketBuffer},
    {"packet size", CheckMtu},
    {"packet loss", CheckPackets},
    {"trigger to picture", CheckLatency},
    {"levels", CheckLevels},
    {"disk speed", CheckDiskSpeed},
    {"disk space", CheckFreeSpace},
    {"clock", CheckSteadyClock},
    {"time of day", CheckTimeOfDay},
    {"calibration's pictures", CheckCalibrationPictures},
    {"calibration's devices", CheckCalibrationDevices},
    {"once around", CheckTurn},
};

}  // namespace

Result<std::vector<Check>> Examine(Patient& patient,
                                   const std::function<void(const Check&)>& tell) {
  const WantedDevices named{patient.config.table.has_value(), patient.config.camera.has_value()};
  auto devices = MakeDevices(patient.config, named, *patient.drivers);
  if (!devices) return Forward(devices);
  patient.devices = std::move(*devices);
  std::vector<Check> checks;
  for (const ListedCheck& listed : kChecks) {
    Check check = listed.run(patient);
    if (StopRequested(patient.stop)) return InterruptedError();
    check.name = listed.name;
    tell(check);
    checks.push_back(std::move(check));
  }
  return checks;
}

}  // namespace turnlight::app
