#include <algorithm>
#include <cctype>
#include <iostream>
#include <memory>
#include <string>

#include "app/calibrate/calibrate_commands.h"
#include "app/calibrate/raw_taking.h"
#include "app/exit_code.h"
#include "app/interrupt.h"
#include "base/format.h"

namespace turnlight::app {
namespace {

// Beyond it a picture of a board or a target is missing something.
constexpr double kMuchFull = 0.02;

struct CaptureArguments {
  std::string config, out;
  RawOrder order;
  std::optional<double> gain_db;
};

void SayOfCapture(const std::string& text) { std::cerr << text << std::endl; }

std::string FullText(const RawTaken& taken) {
  if (taken.full_share < kMuchFull) return "";
  return Format(
      "note: %.0f %% of the first picture's values read full; a shorter exposure would "
      "show more\n",
      100.0 * taken.full_share);
}

int CaptureForCalibration(const CaptureArguments& arguments) {
  const InterruptHaltsMotor guard;
  auto config = ReadDeviceConfig(arguments.config);
  if (!config) return Fail(config.error());
  if (arguments.gain_db) config->plan.gain_db = *arguments.gain_db;
  auto taken = TakeRawCapture(*config, arguments.order, arguments.out, BuiltInDrivers(),
                              {&InterruptFlag(), SayOfCapture});
  if (!taken) {
    Error error = taken.error();
    if (error.kind == ErrorKind::kDevice || error.kind == ErrorKind::kInterrupted)
      error.text += "; what was taken is safe, the same command goes on";
    return Fail(error);
  }
  std::cout << arguments.out
            << Format(": %zu pictures of kind %s, %zu of them taken now",
                      taken->taken + taken->kept, arguments.order.kind.c_str(), taken->taken)
            << "\n"
            << FullText(*taken) << std::flush;
  return kDone;
}

std::string CheckKind(const std::string& word) {
  const bool good = !word.empty() && word.size() <= 40 &&
                    std::all_of(word.begin(), word.end(), [](unsigned char c) {
                      return std::isalnum(c) != 0 || c == '-' || c == '_';
                    });
  return good ? "" : "\"" + word + "\" is no word of letters, digits, - and _";
}

// What is taken.
void AddOrder(CLI::App* command, const std::shared_ptr<CaptureArguments>& arguments) {
  RawOrder& order = arguments->order;
  command
      ->add_option(
          "--kind", order.kind,
          "What the pictures show: board, target, empty, flat, dark, grey, lamp-off, ball, "
          "or a word of yours")
      ->type_name("WORD")
      ->check(CheckKind)
      ->capture_default_str();
  command
      ->add_option("--exposures", order.exposures_us,
                   "In microseconds, at each angle; else those of the section capture")
      ->type_name("US,US,...")
      ->delimiter(',')
      ->check(CLI::Range(0.1, 1e8));
  command
      ->add_option_function<double>(
          "--gain", [arguments](const double& gain_db) { arguments->gain_db = gain_db; },
          "Instead of the config's")
      ->type_name("DB")
      ->check(CLI::Range(-40.0, 80.0));
  command
      ->add_option("--pairs", order.pairs,
                   "Pairs of pictures alike at each exposure, for the noise; 0: one picture")
      ->type_name("N")
      ->check(CLI::Range(0, 1000));
  command->add_flag(
      "--no-move", [arguments](std::int64_t) { arguments->order.move = false; },
      "Leave the table alone, and take --count pictures where it stands");
  command
      ->add_option("--count", order.count, "How many places, or poses of a board, without moving")
      ->type_name("N")
      ->check(CLI::Range(1, 10000));
  command->add_flag("--ask", order.ask,
                    "With --no-move: wait for Enter before each, for a board held by hand");
}

}  // namespace

void AddCalibrateCapture(CLI::App& calibrate, Action& action) {
  CLI::App* command = AddCommand(
      calibrate, "capture",
      "Take raw pictures for a calibration, with a rig of which nothing is known yet: the config "
      "needs no more than rig: {table, camera}, and a section capture for the angles. Says first "
      "what will move, and homes first if the position is unknown. Ctrl-C halts the motor; the "
      "same command goes on with what is missing. Several kinds may share a folder",
      "turnlight calibrate capture my_rig.yaml --out board\n"
      "  turnlight calibrate capture my_rig.yaml --out response --kind flat --no-move "
      "--exposures 1000,2000,4000 --pairs 2");
  auto arguments = std::make_shared<CaptureArguments>();
  command->add_option("CONFIG", arguments->config, "A config with rig: {table, camera}")
      ->required();
  AddOut(*command, arguments->out, "Folder for capture.json and the pictures");
  AddOrder(command, arguments);
  command->callback(
      [arguments, &action] { action = [arguments] { return CaptureForCalibration(*arguments); }; });
}

}  // namespace turnlight::app
