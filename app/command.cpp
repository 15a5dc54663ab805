#include "app/command.h"

#include "base/parallel.h"
#include "estimator/from_session/session_estimate.h"

namespace turnlight::app {

CLI::App* AddCommand(CLI::App& program, const std::string& name, const std::string& description,
                     const std::string& example) {
  CLI::App* command = program.add_subcommand(name, description);
  command->footer("Example:\n  " + example);
  command
      ->add_option_function<int>(
          "--threads", [](const int& threads) { SetThreads(threads); },
          "Worker threads; 0 means one per processor. Results do not depend on it")
      ->type_name("N")
      ->check(CLI::Range(0, 1024));
  return command;
}

void AddOut(CLI::App& command, std::string& out, const std::string& description) {
  command.add_option("--out", out, description)
      ->required()
      ->type_name("DIR")
      ->check([](const std::string& folder) {
        return folder.empty() ? std::string("\"\" is no folder's name") : std::string();
      });
}

void AddPixels(CLI::App& command, std::optional<std::size_t>& pixels) {
  command
      .add_option("--pixels", pixels,
                  "Hold at most N of the target's pixels in memory, evenly chosen (default 16 "
                  "million); fewer take less memory and time")
      ->type_name("N")
      ->check(CLI::Range(estimator::from_session::kFewestPixels,
                         estimator::from_session::kMostPixelsAllowed));
}

}  // namespace turnlight::app
