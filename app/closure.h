// The closure check, told to a person.
#pragma once

#include <filesystem>
#include <optional>

#include "base/result.h"
#include "rig/capture/closure_check.h"

namespace turnlight::app {

// Says the verdict on standard error.
void TellVerdict(const rig::ClosureCheck& closure);

// Checks a finished session and says the verdict on standard error; says nothing of a session
// without a closure frame. Fails (kInput) like rig::CheckClosure.
Result<std::optional<rig::ClosureCheck>> TellClosure(const std::filesystem::path& session);

// The exit code that the verdict means: done, or a device fault.
int ExitCodeOf(const std::optional<rig::ClosureCheck>& closure);

}  // namespace turnlight::app
