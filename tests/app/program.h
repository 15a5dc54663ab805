// Runs the real program, and gives tests a folder to run it in.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

#include "rig/sim/synthetic_config.h"
#include "tests/temporary_folder.h"

namespace turnlight::app {

struct Outcome {
  int exit_code = -1;  // -1: killed by a signal
  std::string out;     // standard output
  std::string err;     // standard error
};

// Runs the program to its end. environment: further variables, NAME=VALUE.
Outcome RunProgram(const std::vector<std::string>& arguments,
                   const std::vector<std::string>& environment = {});

// Starts the program with its outputs thrown away or sent to files; Finish waits for its end.
pid_t Start(const std::vector<std::string>& arguments, const std::string& err = "/dev/null",
            const std::string& out = "/dev/null");
int Finish(pid_t process);

std::string ReadText(const std::filesystem::path& path);
void WriteText(const std::filesystem::path& path, const std::string& text);
// 0 of a file that is not there.
std::size_t Lines(const std::filesystem::path& file);
std::size_t Count(const std::string& text, const std::string& what);
// A test failure if `what` is not in the text.
void Replace(std::string& text, const std::string& what, const std::string& by);

// Makes a run's config one for real time with little to wait for.
void RunQuickly(std::string& config);

// A calibration's file with one text replaced, and without the checksum that would show it.
void EditCalibration(const std::string& path, const std::string& what, const std::string& by);

// What `verify` says of a session's bytes; a test failure if the session is not good.
std::string ContentOf(const std::string& session);
// result.json of a result's folder but for what its times are, as text.
std::string ResultWithoutTimes(const std::string& result);

// A loopback address of this process alone, for a simulated camera.
std::string OwnAddress();

// A small noiseless config: a ball under one near light, three views of 80 x 60 pixels, 16 bits.
rig::sim::SyntheticConfig SmallConfig();
// A ball of 40 mm in the middle of a table that turns once round, 320 x 240 pixels, no masks.
rig::sim::SyntheticConfig BallOnTableConfig(int frames);

// configs/simulated_orbit.yaml with three frames of 64 x 48 pixels.
std::string SmallRunConfig();

// Writes the config's session; a test failure if that is not possible.
void WriteSession(const rig::sim::SyntheticConfig& config, const std::filesystem::path& folder);

}  // namespace turnlight::app
