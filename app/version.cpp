#include "app/version.h"

namespace turnlight::app {

std::string VersionText() {
  return "turnlight " TURNLIGHT_VERSION " (commit " TURNLIGHT_COMMIT ")";
}

}  // namespace turnlight::app
