#include <iostream>
#include <memory>

#include "app/command.h"
#include "app/exit_code.h"
#include "app/interrupt.h"
#include "base/printable.h"
#include "rig/capture/closure_check.h"
#include "rig/session/session.h"

namespace turnlight::app {
namespace {

std::string Count(std::size_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

int Verify(const std::string& folder) {
  const InterruptAtOnce reading_only;
  const auto report = rig::VerifySession(folder);
  if (!report) return Fail(report.error());
  for (const std::string& remark : report->remarks)
    std::cout << "remark: " << Printable(remark) << "\n";
  if (report->problems.empty()) {
    const auto closure = rig::CheckClosure(folder);
    if (!closure || *closure)
      std::cout << "remark: closure: "
                << Printable(closure ? (*closure)->text : closure.error().text) << "\n";
  }
  for (const std::string& problem : report->problems)
    std::cout << "problem: " << Printable(problem) << "\n";
  if (report->problems.empty()) {
    std::cout << folder << ": good, " << Count(report->frames, "frame") << "\n"
              << "content sha256 " << report->content_sha256 << std::endl;
    return kDone;
  }
  std::cout << folder << ": " << Count(report->problems.size(), "problem") << ", "
            << Count(report->frames, "good frame") << std::endl;
  return report->session_good && report->frames > 0 ? kIncomplete : kRefused;
}

}  // namespace

void AddVerify(CLI::App& program, Action& action) {
  CLI::App* command = AddCommand(
      program, "verify",
      "Check a session: every file, checksum, pose and size. Exit code 0 if all is well, 3 if some "
      "frames are bad and the rest is good, 2 otherwise",
      "turnlight verify my_session");
  auto folder = std::make_shared<std::string>();
  command->add_option("SESSION", *folder, "The session's folder")->required();
  command->callback([folder, &action] { action = [folder] { return Verify(*folder); }; });
}

}  // namespace turnlight::app
