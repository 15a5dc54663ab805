// Runs the real program, and gives tests a folder to run it in.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

#include "rig/sim/synthetic_config.h"

namespace turnlight::app {

struct Outcome {
  int exit_code = -1;  // -1: killed by a signal
  std::string out;     // standard output
  std::string err;     // standard error
};

// Runs the program to its end. environment: further variables, NAME=VALUE.
Outcome RunProgram(const std::vector<std::string>& arguments,
                   const std::vector<std::string>& environment = {});

// Starts the program with its output thrown away; Finish waits for its end.
pid_t Start(const std::vector<std::string>& arguments);
int Finish(pid_t process);

// A folder of its own, removed at the end.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }
  // The path of a file or folder in it.
  std::string operator/(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

std::string ReadText(const std::filesystem::path& path);
void WriteText(const std::filesystem::path& path, const std::string& text);

// A small noiseless config: a ball under one near light, three views of 80 x 60 pixels, 16 bits.
rig::SyntheticConfig SmallConfig();

// configs/simulated_orbit.yaml with three frames of 64 x 48 pixels.
std::string SmallRunConfig();

// Writes the config's session; a test failure if that is not possible.
void WriteSession(const rig::SyntheticConfig& config, const std::filesystem::path& folder);

}  // namespace turnlight::app
