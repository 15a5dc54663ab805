// Where a command may write.
#pragma once

#include <filesystem>

#include "base/result.h"

namespace turnlight::app {

// Refuses (kInput) as a folder for output: a file, what cannot be written or made, and a folder
// that is the session's or lies within it, as raw data never changes. Creates nothing; asked before
// the work, so that none is lost.
Status CheckOutputFolder(const std::filesystem::path& out, const std::filesystem::path& session);

// Refuses (kInput) as a session's folder whatever is not new or empty: sessions are never written
// over. Creates nothing.
Status CheckNewFolder(const std::filesystem::path& out);

}  // namespace turnlight::app
