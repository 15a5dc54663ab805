// What the commands share. Each command declares its options with CLI11 and leaves an action to be
// run once the whole line has been understood.
#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>

namespace turnlight::app {

// Gives the exit code.
using Action = std::function<int()>;

void AddRun(CLI::App& program, Action& action);
void AddPlan(CLI::App& program, Action& action);
void AddCapture(CLI::App& program, Action& action);
void AddResume(CLI::App& program, Action& action);
void AddReplay(CLI::App& program, Action& action);
void AddGraph(CLI::App& program, Action& action);
void AddEstimate(CLI::App& program, Action& action);
void AddRender(CLI::App& program, Action& action);
void AddSimulate(CLI::App& program, Action& action);
void AddSynthesize(CLI::App& program, Action& action);
void AddVerify(CLI::App& program, Action& action);
void AddCompare(CLI::App& program, Action& action);
void AddConfig(CLI::App& program, Action& action);
void AddDevices(CLI::App& program, Action& action);
void AddHome(CLI::App& program, Action& action);
void AddJog(CLI::App& program, Action& action);
void AddSnap(CLI::App& program, Action& action);
void AddDoctor(CLI::App& program, Action& action);
void AddRegister(CLI::App& program, Action& action);
void AddCalibrate(CLI::App& program, Action& action);

// A command with its help, an example below it, and --threads.
CLI::App* AddCommand(CLI::App& program, const std::string& name, const std::string& description,
                     const std::string& example);

// --out DIR, required. An empty word, of a shell's variable that is not set, is no folder.
void AddOut(CLI::App& command, std::string& out, const std::string& description);

// --pixels N of what estimates.
void AddPixels(CLI::App& command, std::optional<std::size_t>& pixels);

}  // namespace turnlight::app
