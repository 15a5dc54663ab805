// The commands for single devices, as functions of their arguments: home, jog, snap, doctor. Each
// says on standard error what it will move before it moves it, and gives the exit code.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "app/drivers.h"
#include "app/motion_words.h"

namespace turnlight::app {

struct MotionArguments {
  std::string config;
  std::optional<double> timeout_s;  // else by the config and the way
  bool no_home = false;             // refuse to home where the position is unknown
};
int RunHome(const MotionArguments& arguments, const Drivers& drivers);
int RunJog(const MotionArguments& arguments, const JogTarget& target, const Drivers& drivers);

struct SnapArguments {
  std::string config, out;
  std::optional<double> exposure_us = {}, gain_db = {};  // else the config's
  std::optional<double> timeout_s = {};
};
int RunSnap(const SnapArguments& arguments, const Drivers& drivers);

struct DoctorArguments {
  std::string config;
  std::string out = ".";  // where runs will be written
  std::string junit;      // a file; empty: none
  bool json = false, no_move = false;
};
int RunDoctor(const DoctorArguments& arguments, const Drivers& drivers);

}  // namespace turnlight::app
