#include <arpa/inet.h>
#include <signal.h>

#include <chrono>
#include <ctime>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include "app/command.h"
#include "app/exit_code.h"
#include "app/interrupt.h"
#include "app/outputs.h"
#include "app/simulator.h"
#include "base/file.h"
#include "base/format.h"
#include "estimator/results/scene_json.h"
#include "rig/sim/blob.h"

namespace turnlight::app {
namespace {

using SimulateClock = std::chrono::steady_clock;

constexpr long kSimulatePollNs = 20'000'000;

struct SimulateArguments {
  std::string config, link, address, calibration, target, truth;
  std::optional<double> seconds;
  bool quiet = false;
};

// From here on, and in the threads that are begun while one lives, Ctrl-C, SIGTERM and SIGHUP wait
// to be asked for.
class AskedSignals {
 public:
  AskedSignals() {
    sigemptyset(&set_);
    sigaddset(&set_, SIGINT);
    sigaddset(&set_, SIGTERM);
    if (!HangupIsIgnored()) sigaddset(&set_, SIGHUP);
    ::pthread_sigmask(SIG_BLOCK, &set_, &before_);
  }
  ~AskedSignals() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  AskedSignals(const AskedSignals&) = delete;
  AskedSignals& operator=(const AskedSignals&) = delete;

  // Whether one comes within a moment.
  bool Wait() const {
    const timespec moment{0, kSimulatePollNs};
    return ::sigtimedwait(&set_, nullptr, &moment) > 0;
  }

 private:
  sigset_t set_{}, before_{};
};

Status Override(const SimulateArguments& arguments, SimulatorConfig& config) {
  if (!arguments.link.empty()) {
    if (!config.table)
      return InputError("--link names the port of a simulated table, and " + arguments.config +
                        " has no devices/table");
    config.table->link = arguments.link;
  }
  if (arguments.address.empty()) return {};
  if (!config.camera)
    return InputError("--address is that of a simulated camera, and " + arguments.config +
                      " has no devices/camera");
  in_addr parsed{};
  if (::inet_pton(AF_INET, arguments.address.c_str(), &parsed) != 1)
    return InputError("--address: " + arguments.address +
                      ", allowed is an IPv4 address such as 127.0.0.1");
  config.camera->address = arguments.address;
  return {};
}

// The scene's files, of what is asked for.
Status WriteScene(const SimulateArguments& arguments, const SimulatorConfig& config) {
  if (arguments.target.empty() && arguments.truth.empty()) return {};
  const auto world = rig::sim::BuildWorld(config.simulation);
  if (!world) return Forward(world);
  if (!arguments.target.empty()) {
    const auto* mesh = std::get_if<calib::MeshShape>(&world->studio->target);
    if (!mesh)
      return InputError("--target: the target of " + arguments.config +
                        " is no mesh; a config's target takes its shape and size as they are");
    if (Status status = WriteFileAtomic(arguments.target, rig::sim::MeshToPly(*mesh)); !status)
      return status;
  }
  if (arguments.truth.empty()) return {};
  const std::string note = "the simulated rig of " + arguments.config;
  return WriteFileAtomic(arguments.truth,
                         estimator::results::TruthToJson(world->studio->scene, note));
}

// What was asked for as files, instead of running.
Status WriteSimulated(const SimulateArguments& arguments, const SimulatorConfig& config) {
  if (const Status status = WriteScene(arguments, config); !status) return status;
  if (arguments.calibration.empty()) return {};
  const auto calibration = CalibrationOf(config);
  if (!calibration) return Forward(calibration);
  return rig::WriteRigCalibration(*calibration, arguments.calibration);
}

void ShowFaults(const rig::sim::FaultScript& script, std::size_t& shown) {
  const auto fired = script.Fired();
  for (; shown < fired.size(); ++shown) {
    const rig::sim::FiredFault& fault = fired[shown];
    std::cerr << "fault: " << rig::sim::FaultWord(fault.entry.kind) << " of the "
              << rig::sim::FaultWord(fault.entry.device) << " at "
              << NumberText(fault.commanded_deg) << " degrees, after "
              << Format("%.3f", static_cast<double>(fault.time.count()) * 1e-9) << " s"
              << std::endl;
  }
}

int RunDevices(const SimulateArguments& arguments, SimulatorConfig config) {
  const AskedSignals signals;
  auto started = Simulator::Start(std::move(config));
  if (!started) return Fail(started.error());
  std::unique_ptr<Simulator> simulator = std::move(*started);
  std::cout << "ready: " << simulator->Where() << std::endl;
  const auto begin = SimulateClock::now();
  const auto is_over = [&] {
    return arguments.seconds &&
           std::chrono::duration<double>(SimulateClock::now() - begin).count() >=
               *arguments.seconds;
  };
  std::size_t shown = 0;
  while (!signals.Wait() && !Interrupted() && !is_over())
    if (!arguments.quiet) ShowFaults(simulator->faults(), shown);
  if (!arguments.quiet) ShowFaults(simulator->faults(), shown);
  const std::string counts = simulator->Counts();
  simulator.reset();
  std::cout << "end: " << counts << std::endl;
  return kDone;
}

int Simulate(const SimulateArguments& arguments) {
  auto config = ReadSimulatorConfig(arguments.config);
  if (!config) return Fail(config.error());
  if (const Status status = Override(arguments, *config); !status) return Fail(status.error());
  if (arguments.calibration.empty() && arguments.target.empty() && arguments.truth.empty())
    return RunDevices(arguments, std::move(*config));
  const Status written = WriteSimulated(arguments, *config);
  return written ? kDone : Fail(written.error());
}

}  // namespace

void AddSimulate(CLI::App& program, Action& action) {
  CLI::App* command = AddCommand(
      program, "simulate",
      "Run simulated devices on their real protocols, for hardware in the loop where there is no "
      "hardware: a stage's controller on a pseudo-terminal and a GigE Vision camera on the "
      "loopback. Prints a line that begins with \"ready:\" once both can be opened, and ends "
      "cleanly on Ctrl-C, SIGTERM and SIGHUP",
      "turnlight simulate configs/sim_grbl.yaml --for 60");
  auto arguments = std::make_shared<SimulateArguments>();
  command->add_option("CONFIG", arguments->config, "A YAML file with a scene and devices")
      ->required();
  command->add_option("--for", arguments->seconds, "End after so many seconds")
      ->type_name("SECONDS")
      ->check(CLI::PositiveNumber);
  command->add_option("--link", arguments->link, "Name of the port, instead of the config's")
      ->type_name("PATH");
  command->add_option("--address", arguments->address, "Of the camera, instead of the config's")
      ->type_name("IP");
  command
      ->add_option("--calibration", arguments->calibration,
                   "Write what is true of the rig as rig-calibration.json, and end")
      ->type_name("FILE");
  command
      ->add_option("--target", arguments->target,
                   "Write the target's mesh as PLY, for a rig's config, and end")
      ->type_name("FILE");
  command->add_option("--truth", arguments->truth, "Write the scene as truth.json, and end")
      ->type_name("FILE");
  command->add_flag("--quiet", arguments->quiet, "No line for each fault that strikes");
  command->callback(
      [arguments, &action] { action = [arguments] { return Simulate(*arguments); }; });
}

}  // namespace turnlight::app
