#include <iostream>
#include <memory>

#include "app/calibrate/rig_recipe.h"
#include "app/command.h"
#include "app/exit_code.h"
#include "app/rig_config.h"
#include "app/run_config.h"
#include "app/simulator.h"
#include "rig/sim/synthetic_config.h"

namespace turnlight::app {
namespace {

Status CheckRun(const std::string& file) {
  const auto config = ReadRunConfig(file);
  if (!config) return Forward(config);
  const auto rig = MakeRig(*config);
  if (!rig) return Forward(rig);
  const auto graph = BuildGraph(*config, *rig);
  return graph ? Status() : Forward(graph);
}

// Of synthesize or simulate.
Status CheckScene(const std::string& file) {
  const auto is_simulator = IsSimulatorConfig(file);
  if (!is_simulator) return Forward(is_simulator);
  if (*is_simulator) {
    const auto config = ReadSimulatorConfig(file);
    return config ? Status() : Forward(config);
  }
  const auto config = rig::sim::ReadSyntheticConfig(file);
  return config ? Status() : Forward(config);
}

int CheckFile(const std::string& file) {
  const auto is_recipe = IsRigRecipe(file);
  if (!is_recipe) return Fail(is_recipe.error());
  const auto is_run = IsRunConfig(file);
  if (!is_run) return Fail(is_run.error());
  if (*is_recipe) {
    if (const auto recipe = ReadRigRecipe(file); !recipe) return Fail(recipe.error());
  } else if (*is_run) {
    if (const Status status = CheckRun(file); !status) return Fail(status.error());
  } else if (const Status status = CheckScene(file); !status) {
    return Fail(status.error());
  }
  std::cout << file << ": good" << std::endl;
  return kDone;
}

int Show(const std::string& file) {
  const auto is_run = IsRunConfig(file);
  if (!is_run) return Fail(is_run.error());
  if (*is_run)
    return Fail({ErrorKind::kInput,
                 file + ": a config for turnlight run, allowed is one for turnlight synthesize; "
                        "turnlight plan and turnlight graph show this one"});
  const auto config = rig::sim::ReadSyntheticConfig(file);
  if (!config) return Fail(config.error());
  std::cout << rig::sim::ToYaml(*config) << std::flush;
  return kDone;
}

void AddPart(CLI::App& parent, Action& action, const std::string& name,
             const std::string& description, const std::string& file_for,
             int (*run)(const std::string&)) {
  CLI::App* command = AddCommand(parent, name, description,
                                 "turnlight config " + name + " configs/synthetic_sphere.yaml");
  auto file = std::make_shared<std::string>();
  command->add_option("CONFIG", *file, "A YAML file for turnlight " + file_for)->required();
  command->callback([file, run, &action] { action = [file, run] { return run(*file); }; });
}

}  // namespace

void AddConfig(CLI::App& program, Action& action) {
  CLI::App* command = program.add_subcommand("config", "Check a configuration, or show all of it");
  command->require_subcommand(1);
  command->footer("Example:\n  turnlight config show configs/synthetic_sphere.yaml");
  AddPart(*command, action, "check", "Check a configuration without running it",
          "synthesize, simulate, run or calibrate rig", CheckFile);
  AddPart(*command, action, "show", "Print every key with its value, defaults included",
          "synthesize", Show);
}

}  // namespace turnlight::app
