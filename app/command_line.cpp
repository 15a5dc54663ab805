#include "app/command_line.h"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "app/command.h"
#include "app/exit_code.h"
#include "app/interrupt.h"
#include "app/outputs.h"
#include "app/printable_output.h"
#include "app/version.h"
#include "base/format.h"
#include "base/nearest.h"

namespace turnlight::app {
namespace {

void Configure(CLI::App& program, Action& action) {
  program.require_subcommand(1);
  program.set_version_flag("--version", VersionText());
  program.footer(
      "Example:\n  turnlight estimate my_session --out result\n\n"
      "turnlight COMMAND --help explains a command.");
  AddRun(program, action);
  AddPlan(program, action);
  AddCapture(program, action);
  AddResume(program, action);
  AddReplay(program, action);
  AddGraph(program, action);
  AddEstimate(program, action);
  AddRender(program, action);
  AddSimulate(program, action);
  AddSynthesize(program, action);
  AddVerify(program, action);
  AddCompare(program, action);
  AddConfig(program, action);
  AddDevices(program, action);
  AddHome(program, action);
  AddJog(program, action);
  AddSnap(program, action);
  AddDoctor(program, action);
  AddRegister(program, action);
  AddCalibrate(program, action);
}

// The command that the line got to, "config show" for example.
const CLI::App& Innermost(const CLI::App& program) {
  const auto chosen = program.get_subcommands();
  return chosen.empty() ? program : Innermost(*chosen.front());
}

std::vector<std::string> OptionNames(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

std::vector<std::string> CommandNames(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::App* sub : command.get_subcommands(nullptr)) names.push_back(sub->get_name());
  return names;
}

// The known word nearest to the unknown one; the dashes of options are no letters.
std::string NearestWord(const std::string& name, const std::vector<std::string>& known) {
  const std::size_t begin = std::min(name.find_first_not_of('-'), name.size());
  std::vector<std::string> bare;
  for (const std::string& word : known) bare.push_back(word.substr(word.find_first_not_of('-')));
  const std::string nearest = Nearest(name.substr(begin), bare);
  return nearest.empty() ? nearest : (begin > 0 ? "--" : "") + nearest;
}

std::string UnknownWordOf(const CLI::App& command) {
  for (const std::string& word : command.remaining()) {
    const bool is_option = word.size() > 1 && word[0] == '-';
    const bool wants_command = !is_option && !CommandNames(command).empty();
    if (!is_option && !wants_command) continue;
    const std::string name = word.substr(0, word.find('='));
    const std::string nearest =
        NearestWord(name, is_option ? OptionNames(command) : CommandNames(command));
    return (is_option ? "unknown option " : "unknown command ") + name +
           (nearest.empty() ? "" : ", did you mean " + nearest + "?");
  }
  return "";
}

// CLI11 reports the first thing that it noticed, which may be a consequence of a misspelt word: the
// unknown word is what the user wants to hear of.
std::string UnknownWord(const CLI::App& program) {
  const std::string unknown = UnknownWordOf(Innermost(program));
  return unknown.empty() ? UnknownWordOf(program) : unknown;
}

std::string FullName(const CLI::App& command) {
  return command.get_parent() ? FullName(*command.get_parent()) + " " + command.get_name()
                              : command.get_name();
}

// What is wrong with a line whose words are all known.
std::string WhatIsWrong(const CLI::App& program, const CLI::ParseError& error) {
  const CLI::App& command = Innermost(program);
  if (CommandNames(command).empty() || !dynamic_cast<const CLI::RequiredError*>(&error))
    return error.what();
  return "a command is missing, allowed are " + Listed(CommandNames(command));
}

int Refuse(const CLI::App& program, const CLI::ParseError& error) {
  const std::string unknown = UnknownWord(program);
  std::cerr << "turnlight: " << (unknown.empty() ? WhatIsWrong(program, error) : unknown) << "\n"
            << FullName(Innermost(program)) << " --help shows what is allowed" << std::endl;
  return kRefused;
}

int ParseAndRun(int argc, char** argv) {
  CLI::App program(
      "Estimates the lights around a target and how its surface reflects them, with "
      "error bars, from photographs with known poses.",
      "turnlight");
  Action action;
  Configure(program, action);
  try {
    program.parse(argc, argv);
  } catch (const CLI::Success& help_or_version) {
    return program.exit(help_or_version);
  } catch (const CLI::ParseError& error) {
    return Refuse(program, error);
  }
  return action();
}

int RunSafely(int argc, char** argv) {
  try {
    return ParseAndRun(argc, argv);
  } catch (const std::bad_alloc&) {
    return Fail({ErrorKind::kSystem,
                 "not enough memory for this input; turnlight estimate needs less with --pixels, "
                 "--views or --frames"});
  } catch (const std::exception& error) {
    return Fail(
        {ErrorKind::kSystem,
         std::string("unexpected, and a fault of turnlight: ") + error.what() +
             "; please report it with this command line and what turnlight --version says"});
  }
}

}  // namespace

int RunCommandLine(int argc, char** argv) {
  StandardOutput output;
  int exit_code = kDone;
  {
    const PrintableOutput printable;
    InstallInterruptHandler();
    const OutputWatch watch({STDERR_FILENO}, LoseOutput);
    exit_code = RunSafely(argc, argv);
  }
  return output.End(exit_code);
}

}  // namespace turnlight::app
