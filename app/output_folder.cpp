#include "app/output_folder.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

namespace turnlight::app {

namespace fs = std::filesystem;

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
  fs::path there = real_out;
  while (!fs::exists(there, code) && there != there.parent_path()) there = there.parent_path();
  if (!fs::is_directory(there, code))
    return InputError("--out: " + (there == real_out ? out : there).string() +
                      " is a file, allowed is a folder");
  if (::access(there.c_str(), W_OK | X_OK) != 0)
    return InputError("--out: " + out.string() + ": cannot write in " + there.string() + ": " +
                      std::generic_category().message(errno));
  return {};
}

Status CheckNewFolder(const fs::path& out) {
  std::error_code code;
  if (!fs::exists(out, code)) return {};
  if (!fs::is_directory(out, code))
    return InputError("--out: " + out.string() + " is a file, allowed is a new or empty folder");
  if (!fs::is_empty(out, code))
    return InputError("--out: " + out.string() +
                      " is not empty, allowed is a new or empty folder: sessions are never "
                      "written over");
  return {};
}

}  // namespace turnlight::app
