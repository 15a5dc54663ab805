// Which turnlight this is.
#pragma once

#include <string>

namespace turnlight::app {

// For example "turnlight 0.1.0 (commit 23ecb44)"; the commit is that of the tree when it was
// configured, "unknown" outside git.
std::string VersionText();
// Its parts: "0.1.0" and "23ecb44".
std::string Version();
std::string Commit();

}  // namespace turnlight::app
