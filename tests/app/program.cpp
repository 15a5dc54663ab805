#include "tests/app/program.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "rig/sim/synthetic_session.h"

namespace turnlight::app {
namespace {

// Starts the program with its two outputs sent to files.
pid_t Spawn(const std::vector<std::string>& arguments, const std::string& out,
            const std::string& err, const std::vector<std::string>& environment) {
  std::vector<char*> argv{const_cast<char*>(TURNLIGHT_PROGRAM)};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  const pid_t child = ::fork();
  if (child != 0) return child;
  const int flags = O_WRONLY | O_CREAT | O_TRUNC;
  ::dup2(::open(out.c_str(), flags, 0600), STDOUT_FILENO);
  ::dup2(::open(err.c_str(), flags, 0600), STDERR_FILENO);
  for (const std::string& variable : environment) ::putenv(const_cast<char*>(variable.c_str()));
  ::execv(TURNLIGHT_PROGRAM, argv.data());
  ::_exit(127);
}

}  // namespace

pid_t Start(const std::vector<std::string>& arguments, const std::string& err,
            const std::string& out) {
  return Spawn(arguments, out, err, {});
}

int Finish(pid_t process) {
  int status = 0;
  if (::waitpid(process, &status, 0) != process || !WIFEXITED(status)) return -1;
  return WEXITSTATUS(status);
}

Outcome RunProgram(const std::vector<std::string>& arguments,
                   const std::vector<std::string>& environment) {
  const TemporaryFolder folder;
  Outcome outcome;
  outcome.exit_code = Finish(Spawn(arguments, folder / "out", folder / "err", environment));
  outcome.out = ReadText(folder / "out");
  outcome.err = ReadText(folder / "err");
  return outcome;
}

std::string ReadText(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

void WriteText(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

std::size_t Lines(const std::filesystem::path& file) { return Count(ReadText(file), "\n"); }

std::size_t Count(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (std::size_t at = text.find(what); at != std::string::npos;
       at = text.find(what, at + what.size()))
    ++count;
  return count;
}

void Replace(std::string& text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  ASSERT_NE(at, std::string::npos) << what;
  text.replace(at, what.size(), by);
}

void EditCalibration(const std::string& path, const std::string& what, const std::string& by) {
  std::string text = ReadText(path);
  Replace(text, what, by);
  text = std::regex_replace(text, std::regex(",?\\s*\"sha256\": ?\"[0-9a-f]{64}\"(?=\\s*\\}\\s*$)"),
                            "");
  WriteText(path, text);
}

void RunQuickly(std::string& config) {
  Replace(config, "executor: virtual", "executor: wall");
  Replace(config, "max_speed_deg_s: 30, acceleration_deg_s2: 120",
          "max_speed_deg_s: 1000, acceleration_deg_s2: 10000, home_speed_deg_s: 1000");
  Replace(config, "backlash_deg: 0.05", "backlash_deg: 0.05, settle_ms: 10");
  Replace(config, "settle_ms: 300", "settle_ms: 20");
}

std::string ContentOf(const std::string& session) {
  const Outcome verified = RunProgram({"verify", session});
  EXPECT_EQ(verified.exit_code, 0) << verified.out;
  const std::size_t at = verified.out.find("content sha256");
  return at == std::string::npos ? "" : verified.out.substr(at);
}

std::string ResultWithoutTimes(const std::string& result) {
  auto json = nlohmann::json::parse(ReadText(std::filesystem::path(result) / "result.json"));
  json.erase("time_s");
  return json.dump();
}

std::string OwnAddress() {
  const int pid = ::getpid();
  return "127." + std::to_string(100 + pid / 65024 % 8) + "." + std::to_string(pid / 254 % 256) +
         "." + std::to_string(1 + pid % 254);
}

std::string SmallRunConfig() {
  std::string text =
      ReadText(std::filesystem::path(TURNLIGHT_SOURCE_DIR) / "configs/simulated_orbit.yaml");
  Replace(text, "count: 36", "count: 3");
  Replace(text, "step_deg: 10", "step_deg: 120");
  Replace(text, "size: [320, 240], focal_px: 520", "size: [64, 48], focal_px: 104");
  return text;
}

rig::sim::SyntheticConfig SmallConfig() {
  rig::sim::SyntheticConfig config;
  config.name = "small";
  config.motion.frames = 3;
  config.motion.step_deg = 120.0;
  config.camera = {80, 60, 170.0, {}};
  config.lights = std::vector<rig::sim::LightSpec>{{{0.4, 0.3, 0.85}, 600.0, 1.0, {1, 1, 1}}};
  estimator::model::Reflectance reflectance;
  reflectance.albedo = {0.5, 0.4, 0.3};
  reflectance.ambient = 0.1;
  reflectance.diffuse = 0.7;
  reflectance.lobes[0].strength = 0.3;
  reflectance.lobes[0].shape = 30.0;
  config.reflectance = reflectance;
  return config;
}

rig::sim::SyntheticConfig BallOnTableConfig(int frames) {
  rig::sim::SyntheticConfig config = SmallConfig();
  config.motion = {rig::sim::MotionKind::kTable, frames, 360.0 / frames, 420.0, 30.0, 0.0};
  config.camera.width = 320;
  config.camera.height = 240;
  config.camera.focal_px = 520.0;
  config.target = calib::SphereShape{40.0};
  config.sensor.noise_relative = 0.002;
  config.reflectance = rig::sim::RandomReflectance{.ambient = {0.3, 0.4}};
  return config;
}

void WriteSession(const rig::sim::SyntheticConfig& config, const std::filesystem::path& folder) {
  const auto report = rig::sim::WriteSynthetic(config, folder);
  ASSERT_TRUE(report) << report.error().text;
}

}  // namespace turnlight::app
