#include "app/closure.h"

#include <iostream>

#include "app/exit_code.h"
#include "base/printable.h"

namespace turnlight::app {

void TellVerdict(const rig::ClosureCheck& closure) {
  std::cerr << (closure.closed ? "" : "turnlight: ") << "closure: " << Printable(closure.text)
            << std::endl;
}

Result<std::optional<rig::ClosureCheck>> TellClosure(const std::filesystem::path& session) {
  auto closure = rig::CheckClosure(session);
  if (closure && *closure) TellVerdict(**closure);
  return closure;
}

int ExitCodeOf(const std::optional<rig::ClosureCheck>& closure) {
  return closure && !closure->closed ? kDeviceFault : kDone;
}

}  // namespace turnlight::app
