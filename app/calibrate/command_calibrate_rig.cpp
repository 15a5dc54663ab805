#include <memory>

#include "app/calibrate/calibrate_commands.h"
#include "app/calibrate/calibrate_rig.h"

namespace turnlight::app {

void AddCalibrateRig(CLI::App& calibrate, Action& action) {
  CLI::App* command = AddCommand(
      calibrate, "rig",
      "From an unpacked camera to lights in one command: response, lens, axis and target's place, "
      "each from pictures that it takes, then a capture and its estimate with what was found. "
      "Asks for a board, a lens cap and so on as it needs them; a simulated rig has them by its "
      "config. The same command goes on where it was interrupted",
      "turnlight calibrate rig configs/calibrate_hil.yaml --out calibrated");
  auto arguments = std::make_shared<CalibrateRigArguments>();
  command->add_option("CONFIG", arguments->config, "A run's config with the section calibrate")
      ->required();
  auto out = std::make_shared<std::string>();
  AddOut(*command, *out, "Folder for pictures, calibration, run and summary");
  command->add_flag("--yes", arguments->yes, "Ask nobody: all is where it should be");
  command->add_flag(
      "--no-capture", [arguments](std::int64_t) { arguments->capture = false; },
      "End with the calibration");
  command->callback([arguments, out, &action] {
    action = [arguments, out] {
      arguments->out = *out;
      return RunCalibrateRig(*arguments, BuiltInDrivers());
    };
  });
}

}  // namespace turnlight::app
