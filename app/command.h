// What the commands share. Each command declares its options with CLI11 and leaves an action to be
// run once the whole line has been understood.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <string>

#include "base/result.h"

namespace turnlight::app {

// Exit codes of the program.
inline constexpr int kDone = 0;
inline constexpr int kRefused = 2;     // usage, config or input
inline constexpr int kIncomplete = 3;  // some frames lost, the rest kept
inline constexpr int kDeviceFault = 4;
inline constexpr int kInterrupted = 130;

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
void AddSynthesize(CLI::App& program, Action& action);
void AddVerify(CLI::App& program, Action& action);
void AddConfig(CLI::App& program, Action& action);

// A command with its help, an example below it, and --threads.
CLI::App* AddCommand(CLI::App& program, const std::string& name, const std::string& description,
                     const std::string& example);

// Prints the error on standard error and gives its exit code.
int Fail(const Error& error);

// Refuses (kInput) as a folder for output: a file, and a folder that is the session's or lies
// within it, as raw data never changes. Creates nothing.
Status CheckOutputFolder(const std::filesystem::path& out, const std::filesystem::path& session);

}  // namespace turnlight::app
