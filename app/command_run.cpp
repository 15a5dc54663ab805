#include <memory>
#include <optional>
#include <string>

#include "app/capture_run.h"
#include "app/command.h"

namespace turnlight::app {
namespace {

struct RunArguments {
  std::string config, out;
  std::optional<std::size_t> pixels;
};

void AddCapturing(CLI::App& program, Action& action, const std::string& name,
                  const std::string& description, CaptureGoal goal) {
  CLI::App* command =
      AddCommand(program, name, description,
                 "turnlight " + name + " configs/simulated_turntable.yaml --out my_run");
  auto arguments = std::make_shared<RunArguments>();
  command->add_option("CONFIG", arguments->config, "A YAML file with capture, rig and graph")
      ->required();
  AddOut(*command, arguments->out, "Folder for session, log and result; a new one");
  if (goal == CaptureGoal::kEstimate) AddPixels(*command, arguments->pixels);
  command->callback([arguments, goal, &action] {
    action = [arguments, goal] {
      return RunCapture(arguments->config, RunFolder(arguments->out), goal, BuiltInDrivers(),
                        arguments->pixels);
    };
  });
}

}  // namespace

void AddRun(CLI::App& program, Action& action) {
  AddCapturing(program, action, "run",
               "Turn, photograph and estimate: the whole capture, with the estimate improving "
               "behind it. Ctrl-C once finishes the keyframe, twice stops the motor now",
               CaptureGoal::kEstimate);
}

void AddCapture(CLI::App& program, Action& action) {
  AddCapturing(program, action, "capture", "The same as run without any estimate",
               CaptureGoal::kSession);
}

void AddResume(CLI::App& program, Action& action) {
  CLI::App* command =
      AddCommand(program, "resume",
                 "Go on with a run or capture that was interrupted: what is safe on disk is kept, "
                 "and the session ends with the same bytes as if nothing had happened. What began "
                 "as run is estimated at the end",
                 "turnlight resume my_run");
  auto out = std::make_shared<std::string>();
  command->add_option("DIR", *out, "The folder of the run")->required();
  command->callback([out, &action] { action = [out] { return ResumeCapture(RunFolder(*out)); }; });
}

void AddReplay(CLI::App& program, Action& action) {
  CLI::App* command = AddCommand(
      program, "replay",
      "Run the graph again from a log, without devices; gives the same session and result. The "
      "config is read from config.yaml beside the log. A log holds one run: that of a capture that "
      "was interrupted gives the frames up to there (exit code 3)",
      "turnlight replay my_run/log --out again");
  auto arguments = std::make_shared<RunArguments>();
  command->add_option("LOG", arguments->config, "The log of a run")->required();
  AddOut(*command, arguments->out, "Folder for session, log and result; a new one");
  command->callback([arguments, &action] {
    action = [arguments] { return ReplayCapture(arguments->config, RunFolder(arguments->out)); };
  });
}

}  // namespace turnlight::app
