// What doctor found, for a person and for programs.
#pragma once

#include <string>
#include <vector>

#include "app/doctor/check.h"

namespace turnlight::app {

// "ok", "warning", "failed", "skipped".
std::string WordOf(Verdict verdict);

// One check as lines of a table, each ended: verdict, name, figure; below it what to do.
std::string CheckText(const Check& check);
// "23 checks: 12 ok, 2 warnings, 1 failed, 8 skipped", with a line's end.
std::string CountText(const std::vector<Check>& checks);
// {"config": FILE, "checks": [{name, verdict, figure, advice}], "failed": N}.
std::string ChecksJson(const std::string& config, const std::vector<Check>& checks);
// A test suite; a warning is a passed test that says something.
std::string ChecksJunit(const std::vector<Check>& checks);

bool AnyFailed(const std::vector<Check>& checks);

}  // namespace turnlight::app
