#include <iostream>
#include <memory>
#include <string>
#include <utility>

#include "app/command.h"
#include "app/device_commands.h"
#include "app/doctor/doctor.h"
#include "app/doctor/report.h"
#include "app/exit_code.h"
#include "app/interrupt.h"
#include "base/file.h"

namespace turnlight::app {
namespace {

// A config that turnlight run refuses counts as refused, whatever else there is.
int ExitCodeOf(const std::vector<Check>& checks) {
  if (!AnyFailed(checks)) return kDone;
  return checks.front().verdict == Verdict::kFailed ? kRefused : kDeviceFault;
}

}  // namespace

int RunDoctor(const DoctorArguments& arguments, const Drivers& drivers) {
  const InterruptHaltsMotor guard;
  auto config = ReadDeviceConfig(arguments.config);
  if (!config) return Fail(config.error());
  Patient patient(std::move(*config), drivers);
  patient.options = {arguments.out, !arguments.no_move};
  patient.stop = &InterruptFlag();
  patient.say = [](const std::string& text) { std::cerr << text << std::endl; };
  const auto checks = Examine(patient, [&arguments](const Check& check) {
    if (!arguments.json) std::cout << CheckText(check) << std::flush;
  });
  if (!checks) return Fail(checks.error());
  std::cout << (arguments.json ? ChecksJson(arguments.config, *checks) : CountText(*checks))
            << std::flush;
  if (!arguments.junit.empty())
    if (const Status written = WriteFileAtomic(arguments.junit, ChecksJunit(*checks)); !written)
      return Fail(written.error());
  return ExitCodeOf(*checks);
}

void AddDoctor(CLI::App& program, Action& action) {
  CLI::App* command = AddCommand(
      program, "doctor",
      "Examine a rig: permissions, controller, camera, packets, disk, clock, calibration, and "
      "whether the table comes back after a whole turn; each check with a figure and what to do. "
      "Says first what will move. Exit code 0 if nothing failed, 4 if a check failed, 2 if the "
      "config is refused",
      "turnlight doctor my_rig.yaml --no-move");
  auto arguments = std::make_shared<DoctorArguments>();
  command->add_option("CONFIG", arguments->config, "A config with rig/table, rig/camera or both")
      ->required();
  command->add_flag("--no-move", arguments->no_move, "Leave the table where it is");
  command
      ->add_option("--out", arguments->out,
                   "Where runs will be written, for the checks of the disk; else here")
      ->type_name("DIR");
  command->add_flag("--json", arguments->json, "As JSON, and nothing else on standard output");
  command->add_option("--junit", arguments->junit, "Write the checks as JUnit XML, too")
      ->type_name("FILE");
  command->callback([arguments, &action] {
    action = [arguments] { return RunDoctor(*arguments, BuiltInDrivers()); };
  });
}

}  // namespace turnlight::app
