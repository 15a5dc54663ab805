#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/command.h"
#include "app/device_commands.h"
#include "app/device_config.h"
#include "app/exit_code.h"
#include "app/interrupt.h"
#include "app/motion_words.h"
#include "app/progress.h"
#include "app/table_motion.h"
#include "base/format.h"
#include "rig/capture/capture_setup.h"

namespace turnlight::app {
namespace {

constexpr double kHomePatienceS = 120.0;
constexpr double kMaxPatienceS = 86400.0;

// A table that was opened, and how it is moved.
struct OpenedTable {
  DeviceConfig config;
  Devices devices;
  DeviceClock clock;
  StatusLine line;
  std::string name;
  TableMotion motion;
  rig::TableState state;
};

void Say(const std::string& text) { std::cerr << text << std::endl; }

// Not moved by the pointers in it.
Result<std::unique_ptr<OpenedTable>> OpenTable(const MotionArguments& arguments,
                                               const Drivers& drivers) {
  auto config = ReadDeviceConfig(arguments.config);
  if (!config) return Forward(config);
  auto devices = MakeDevices(*config, {.table = true}, drivers);
  if (!devices) return Forward(devices);
  auto opened = std::make_unique<OpenedTable>();
  opened->config = std::move(*config);
  opened->devices = std::move(*devices);
  opened->name = NameOfTable(opened->config);
  rig::Turntable& table = *opened->devices.table->turntable;
  const auto identity = table.Open(opened->clock.Now());
  if (!identity) return Forward(identity);
  Say(opened->name + ": " + rig::Describe(*identity));
  opened->motion = {&table, &opened->clock, &InterruptFlag(), opened->config.plan.tolerance_deg};
  opened->motion.note = [](const std::string& note) { Say("note: " + note); };
  const auto state = WaitUntilStill(
      opened->motion, opened->clock.Now() + FromSeconds(opened->config.plan.move_timeout_s));
  if (!state) return Forward(state);
  opened->state = *state;
  return opened;
}

Status Home(OpenedTable& table, const MotionArguments& arguments) {
  Say(HomeText(table.name));
  table.motion.watch = [&table, begun = table.clock.Now()](const rig::TableState& state) {
    table.line.Show(Format("homing, %.0f s, at %.2f degrees", ToSeconds(table.clock.Now() - begun),
                           state.angle_deg));
  };
  const auto state =
      HomeTable(table.motion, FromSeconds(arguments.timeout_s.value_or(kHomePatienceS)));
  if (!state) return Forward(state);
  table.state = *state;
  return {};
}

Status CheckLimits(const DeviceConfig& config, double angle_deg) {
  const auto& limits = config.plan.limits;
  if (!limits || (angle_deg >= limits->min_deg && angle_deg <= limits->max_deg)) return {};
  return InputError(config.file +
                    Format(": capture/limits_deg: %.6g to %.6g, asked is %.6g degrees",
                           limits->min_deg, limits->max_deg, angle_deg));
}

Status Turn(OpenedTable& table, double to_deg, const MotionArguments& arguments) {
  if (const Status allowed = CheckLimits(table.config, to_deg); !allowed) return allowed;
  const rig::TableKinematics& kinematics = table.devices.table->kinematics;
  Say(TurnText(table.name, table.state.angle_deg, to_deg, kinematics));
  table.motion.watch = [&table, to_deg](const rig::TableState& state) {
    table.line.Show(Format("turning, at %.2f of %.2f degrees", state.angle_deg, to_deg));
  };
  const double seconds = rig::MoveSeconds(kinematics, std::abs(to_deg - table.state.angle_deg));
  const double patience = arguments.timeout_s.value_or(
      std::max(table.config.plan.move_timeout_s, 2.0 * seconds + 10.0));
  const auto state = TurnTable(table.motion, to_deg, FromSeconds(patience));
  if (!state) return Forward(state);
  table.state = *state;
  return {};
}

int Tell(const OpenedTable& table) {
  std::cout << Format("the table stands at %.3f degrees", table.state.angle_deg) << std::endl;
  return kDone;
}

}  // namespace

int RunHome(const MotionArguments& arguments, const Drivers& drivers) {
  const InterruptHaltsMotor guard;
  const auto table = OpenTable(arguments, drivers);
  if (!table) return FailAtDevice(table.error(), arguments.config);
  if (const Status homed = Home(**table, arguments); !homed)
    return FailAtDevice(homed.error(), arguments.config);
  return Tell(**table);
}

int RunJog(const MotionArguments& arguments, const JogTarget& target, const Drivers& drivers) {
  const InterruptHaltsMotor guard;
  const auto opened = OpenTable(arguments, drivers);
  if (!opened) return FailAtDevice(opened.error(), arguments.config);
  OpenedTable& table = **opened;
  if (table.state.motion != rig::TableMotion::kIdle) {
    const std::string why = "the position is not known: " + table.state.fault;
    if (arguments.no_home)
      return Fail({ErrorKind::kDevice, why + "; turnlight home " + arguments.config + " finds it"});
    Say(why + "; homing comes first");
    if (const Status homed = Home(table, arguments); !homed)
      return FailAtDevice(homed.error(), arguments.config);
  }
  const Status turned = Turn(table, target.AngleFrom(table.state.angle_deg), arguments);
  return turned ? Tell(table) : FailAtDevice(turned.error(), arguments.config);
}

namespace {

struct MotionWords {
  std::string first, second;
  MotionArguments arguments;
};

std::shared_ptr<MotionWords> AddMotionOptions(CLI::App& command) {
  auto words = std::make_shared<MotionWords>();
  command
      .add_option("--config", words->arguments.config,
                  "The config, if it is not among the other words")
      ->type_name("CONFIG");
  command
      .add_option_function<double>(
          "--timeout", [words](const double& s) { words->arguments.timeout_s = s; },
          "How long the motion may take before the motor is halted; else by the config and the way")
      ->type_name("SECONDS")
      ->check(CLI::Range(0.1, kMaxPatienceS));
  return words;
}

bool IsJogTarget(const std::string& word) { return ParseJogTarget(word).has_value(); }

}  // namespace

void AddHome(CLI::App& program, Action& action) {
  CLI::App* command = AddCommand(
      program, "home",
      "Find the table's zero. Says first what will move. Ctrl-C halts the motor. The config needs "
      "no more than rig: {table: {driver: ...}}. Exit code 4 if the table reports a fault",
      "turnlight home my_rig.yaml");
  const auto words = AddMotionOptions(*command);
  command->add_option("CONFIG", words->first, "A config with rig/table");
  command->callback([words, &action] {
    action = [words] {
      const auto split = SplitWords({words->first}, words->arguments.config, "", IsJogTarget);
      if (!split) return Fail(split.error());
      words->arguments.config = split->config;
      return RunHome(words->arguments, BuiltInDrivers());
    };
  });
}

void AddJog(CLI::App& program, Action& action) {
  CLI::App* command = AddCommand(
      program, "jog",
      "Turn the table to an angle or by a step, in degrees, counter-clockwise seen from above: 120 "
      "and -10 are angles, +10 is a step ahead, +-10 a step back. Says first what will move, and "
      "homes first if the position is unknown. Ctrl-C halts the motor. The config needs no more "
      "than rig: {table: {driver: ...}}",
      "turnlight jog my_rig.yaml 120\n  turnlight jog +-10 --config my_rig.yaml");
  const auto words = AddMotionOptions(*command);
  command->add_option("CONFIG", words->first, "A config with rig/table");
  command->add_option("ANGLE|+STEP", words->second, "In degrees; may stand before the config");
  command->add_flag("--no-home", words->arguments.no_home,
                    "Refuse instead of homing if the position is unknown");
  command->callback([words, &action] {
    action = [words] {
      const auto split = SplitWords({words->first, words->second}, words->arguments.config,
                                    "an angle or a step, 120, -10, +10 or +-10", IsJogTarget);
      if (!split) return Fail(split.error());
      words->arguments.config = split->config;
      return RunJog(words->arguments, *ParseJogTarget(split->other), BuiltInDrivers());
    };
  });
}

}  // namespace turnlight::app
