// study: measures the estimator on many scenes. `study NAME --help` tells the options.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <string>

#include "bench/studies/random_scene.h"
#include "bench/studies/report.h"
#include "bench/studies/studies.h"
#include "bench/studies/summary.h"

namespace turnlight::studies {
namespace {

struct Arguments {
  std::string scenes;
  std::string data = TURNLIGHT_SHARED_DATA;
  RunOptions run;
  int worst = 10;
  bool check = false;
  std::string file;
  int number = 0;
};

int Refuse(const Error& error) {
  std::cerr << "study: " << error.text << "\n";
  return 2;
}

Result<Range> ParseRange(const std::string& text) {
  Range range;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%d:%d%c", &range.begin, &range.end, &rest) == 2 &&
      range.begin >= 0 && range.begin < range.end && range.end <= 1000000)
    return range;
  return InputError("--scenes: \"" + text + "\", allowed is A:B with 0 <= A < B <= 1000000");
}

int Print(const StudyFile& file, const Arguments& arguments) {
  const Summary summary = Summarise(file, arguments.worst);
  std::cout << file.study << ": " << file.records.size() << " scenes\n" << summary.text;
  return arguments.check && !summary.accepted ? 1 : 0;
}

int Run(const std::string& study, const std::vector<Job>& jobs, const Arguments& arguments) {
  const auto file = RunJobs(study, jobs, arguments.run);
  return file ? Print(*file, arguments) : Refuse(file.error());
}

void AddRunOptions(CLI::App* command, Arguments& arguments) {
  command->add_option("--out", arguments.run.out,
                      "Results, JSON; a run that was stopped goes on with it");
  command->add_flag("--fresh", arguments.run.fresh, "Do scenes again that the file already has");
  command->add_option("--threads", arguments.run.processes, "Scenes at a time")
      ->check(CLI::Range(1, 256));
  command->add_option("--deadline", arguments.run.deadline_s, "Seconds that a scene may take");
  command->add_option("--worst", arguments.worst, "How many of the worst scenes are listed");
  command->add_flag("--check", arguments.check, "Exit code 1 unless every figure holds");
}

CLI::App* AddStudy(CLI::App& app, const char* name, const char* what, const char* scenes,
                   Arguments& arguments) {
  CLI::App* command = app.add_subcommand(name, what);
  arguments.scenes = scenes;
  command->add_option("--scenes", arguments.scenes, "A:B, the scenes A to B - 1")
      ->default_str(scenes);
  AddRunOptions(command, arguments);
  return command;
}

// A study of sessions that lie outside of the repository.
CLI::App* AddDataStudy(CLI::App& app, const char* name, const char* what, Arguments& arguments) {
  CLI::App* command = app.add_subcommand(name, what);
  command->add_option("--data", arguments.data, "The folder of the sessions");
  AddRunOptions(command, arguments);
  return command;
}

CLI::App* AddReport(CLI::App& app, Arguments& arguments) {
  CLI::App* command = app.add_subcommand(
      "report", "Writes docs/accuracy.md and docs/stability.md from the results");
  arguments.data = TURNLIGHT_SOURCE_DIR "/bench/studies/results";
  arguments.file = TURNLIGHT_SOURCE_DIR "/docs";
  command->add_option("--results", arguments.data, "The folder of the results")
      ->default_str("bench/studies/results");
  command->add_option("--docs", arguments.file, "Where to write")->default_str("docs");
  return command;
}

int RunScenes(const char* study, std::vector<Job> (*jobs)(Range), const Arguments& arguments) {
  const auto range = ParseRange(arguments.scenes);
  return range ? Run(study, jobs(*range), arguments) : Refuse(range.error());
}

int RunSessions(const Arguments& arguments) {
  const auto jobs = SessionJobs(arguments.data);
  return jobs ? Run("sessions", *jobs, arguments) : Refuse(jobs.error());
}

// A folder that is gone at the end with all that is in it.
struct ScratchFolder {
  std::string path = (std::filesystem::temp_directory_path() / "study-XXXXXX").string();
  bool made = mkdtemp(path.data()) != nullptr;
  ~ScratchFolder() {
    std::error_code ignored;
    if (made) std::filesystem::remove_all(path, ignored);
  }
};

int RunPhotographs(const Arguments& arguments) {
  constexpr Range kAll{0, 1000000};
  const auto range = arguments.scenes.empty() ? Result<Range>(kAll) : ParseRange(arguments.scenes);
  if (!range) return Refuse(range.error());
  const ScratchFolder scratch;
  if (!scratch.made) return Refuse({ErrorKind::kSystem, scratch.path + ": cannot be made"});
  const auto jobs = PhotographJobs(arguments.data, *range, scratch.path);
  return jobs ? Run("photographs", *jobs, arguments) : Refuse(jobs.error());
}

int RunExtremes(const Arguments& arguments) {
  std::vector<Job> jobs = ExtremeJobs();
  std::erase_if(jobs,
                [&](const Job& job) { return job.id.find(arguments.scenes) == std::string::npos; });
  if (jobs.empty())
    return Refuse({ErrorKind::kInput, "--only: no cell's id contains \"" + arguments.scenes +
                                          "\"; ids are such as 001/shininess/0.5"});
  return Run("extremes", jobs, arguments);
}

int PrintSummary(const Arguments& arguments) {
  const auto file = ReadStudyFile(arguments.file);
  return file ? Print(*file, arguments) : Refuse(file.error());
}

int PrintConfig(const Arguments& arguments) {
  const auto config = arguments.scenes.empty()
                          ? RandomScene(static_cast<std::uint64_t>(arguments.number))
                          : LightConfig(arguments.scenes, arguments.number);
  if (!config) return Refuse(config.error());
  std::cout << rig::sim::ToYaml(*config);
  return 0;
}

int MakeReport(const Arguments& arguments) {
  const Status status = WriteReport(arguments.data, arguments.file);
  return status ? 0 : Refuse(status.error());
}

// The studies of scenes that are made from their numbers.
struct SceneStudy {
  const char* name;
  const char* what;
  const char* scenes;  // all of them
  std::vector<Job> (*jobs)(Range);
};
constexpr SceneStudy kSceneStudies[] = {
    {"random", "Random scenes, no hint (bench/studies/random_scene.h)", "0:200", RandomJobs},
    {"eight", "Eight lights over a ball and a lump, 20 and 10 views", "0:5", EightJobs},
    {"handstart", "Random scenes, started 10 to 70 degrees off", "0:100", HandStartJobs},
    {"coverage", "Random scenes, 20 draws of noise each: do the intervals hold?", "0:32",
     CoverageJobs},
    {"lights", "Few lights: white, coloured, changing, in a field", "0:100", LightJobs},
    {"hard", "Scenes whose lights are hard to count: does the result say so?", "0:240", HardJobs},
    {"shifted", "The random scenes, the target 1e-4 radii elsewhere than said", "0:200",
     ShiftedJobs},
};

int Main(int argc, char** argv) {
  CLI::App app("Measures the estimator on many scenes");
  app.require_subcommand(1);
  Arguments of_scenes[std::size(kSceneStudies)], extremes, sessions, photographs, summary, report,
      config;
  CLI::App* scene_commands[std::size(kSceneStudies)];
  for (std::size_t i = 0; i < std::size(kSceneStudies); ++i) {
    const SceneStudy& study = kSceneStudies[i];
    scene_commands[i] = AddStudy(app, study.name, study.what, study.scenes, of_scenes[i]);
  }
  CLI::App* extremes_command =
      app.add_subcommand("extremes", "One thing at a time taken to its extreme");
  extremes_command->add_option("--only", extremes.scenes, "Cells whose id contains this");
  AddRunOptions(extremes_command, extremes);
  CLI::App* sessions_command = AddDataStudy(
      app, "sessions",
      "Sessions with a truth.json that were made or photographed elsewhere, no hint", sessions);
  CLI::App* photographs_command =
      AddDataStudy(app, "photographs",
                   "Photographs of balls under one to four lights, by three methods", photographs);
  photographs_command->add_option("--scenes", photographs.scenes, "A:B, the scenes A to B - 1")
      ->default_str("all");
  CLI::App* summary_command = app.add_subcommand("summary", "Prints a results file's figures");
  summary_command->add_option("FILE", summary.file, "Results")->required();
  summary_command->add_option("--worst", summary.worst, "How many of the worst scenes are listed");
  summary_command->add_flag("--check", summary.check, "Exit code 1 unless every figure holds");
  CLI::App* report_command = AddReport(app, report);
  CLI::App* config_command =
      app.add_subcommand("config", "Prints a random scene as a config of `turnlight synthesize`");
  config_command->add_option("NUMBER", config.number, "The scene's number")->required();
  config_command->add_option("--lights", config.scenes, "Of the study of lights, of this kind");
  CLI11_PARSE(app, argc, argv);
  for (std::size_t i = 0; i < std::size(kSceneStudies); ++i)
    if (*scene_commands[i])
      return RunScenes(kSceneStudies[i].name, kSceneStudies[i].jobs, of_scenes[i]);
  if (*extremes_command) return RunExtremes(extremes);
  if (*sessions_command) return RunSessions(sessions);
  if (*photographs_command) return RunPhotographs(photographs);
  if (*summary_command) return PrintSummary(summary);
  if (*report_command) return MakeReport(report);
  return PrintConfig(config);
}

}  // namespace
}  // namespace turnlight::studies

int main(int argc, char** argv) { return turnlight::studies::Main(argc, argv); }
