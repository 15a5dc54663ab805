#include "app/command.h"

#include <algorithm>
#include <iostream>
#include <system_error>

#include "base/parallel.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;

constexpr int kNoEstimate = 5;

int ExitCode(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::kInput:
    case ErrorKind::kSystem:
      return kRefused;
    case ErrorKind::kIncomplete:
      return kIncomplete;
    case ErrorKind::kDevice:
      return kDeviceFault;
    case ErrorKind::kNoEstimate:
      return kNoEstimate;
  }
  return kRefused;
}

}  // namespace

CLI::App* AddCommand(CLI::App& program, const std::string& name, const std::string& description,
                     const std::string& example) {
  CLI::App* command = program.add_subcommand(name, description);
  command->footer("Example:\n  " + example);
  command
      ->add_option_function<int>(
          "--threads", [](const int& threads) { SetThreads(threads); },
          "Worker threads; 0 means one per processor. Results do not depend on it")
      ->type_name("N")
      ->check(CLI::Range(0, 1024));
  return command;
}

int Fail(const Error& error) {
  std::cerr << "turnlight: " << error.text << std::endl;
  return ExitCode(error.kind);
}

Status CheckOutputFolder(const fs::path& out, const fs::path& session) {
  std::error_code code;
  const fs::path real_out = fs::weakly_canonical(fs::absolute(out), code);
  if (code) return InputError(out.string() + ": not a usable path: " + code.message());
  const fs::path real_session = fs::weakly_canonical(fs::absolute(session), code);
  if (!code) {
    const auto [end, rest] =
        std::mismatch(real_session.begin(), real_session.end(), real_out.begin(), real_out.end());
    if (end == real_session.end())
      return InputError("--out: " + out.string() + " is the session's folder or lies within it, " +
                        "allowed is a folder outside " + session.string() +
                        ": a session's data never changes");
  }
  if (fs::exists(real_out, code) && !fs::is_directory(real_out, code))
    return InputError("--out: " + out.string() + " is a file, allowed is a folder");
  return {};
}

}  // namespace turnlight::app
