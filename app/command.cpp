#include "app/command.h"

#include "base/parallel.h"

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

}  // namespace turnlight::app
