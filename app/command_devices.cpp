#include <iostream>
#include <memory>

#include "app/command.h"
#include "app/device_list.h"
#include "app/exit_code.h"
#include "app/interrupt.h"

namespace turnlight::app {

void AddDevices(CLI::App& program, Action& action) {
  CLI::App* command = AddCommand(
      program, "devices",
      "List serial ports and cameras, with the lines that name them in a config under rig. Opens "
      "nothing. Exit code 4 if a search failed",
      "turnlight devices");
  auto json = std::make_shared<bool>(false);
  command->add_flag("--json", *json, "As JSON, and nothing else on standard output");
  command->callback([json, &action] {
    action = [json] {
      const InterruptAtOnce looking_only;
      const DeviceList list = FindDevices(BuiltInDrivers());
      std::cout << (*json ? DeviceListJson(list) : DeviceListText(list)) << std::flush;
      return list.problems.empty() ? kDone : kDeviceFault;
    };
  });
}

}  // namespace turnlight::app
