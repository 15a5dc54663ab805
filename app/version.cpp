#include "app/version.h"

namespace turnlight::app {

std::string Version() { return TURNLIGHT_VERSION; }
std::string Commit() { return TURNLIGHT_COMMIT; }
std::string VersionText() { return "turnlight " + Version() + " (commit " + Commit() + ")"; }

}  // namespace turnlight::app
