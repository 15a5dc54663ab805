// Whole files in and out.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "base/result.h"

namespace turnlight {

// Reads a regular file. Fails (kInput) if it is missing, not a regular file, or larger than max_bytes.
Result<std::string> ReadFile(const std::filesystem::path& path,
                             std::uint64_t max_bytes = std::uint64_t{4} << 30);

// Writes so that a reader sees the old file or the whole new one, also after a crash: temporary file
// beside it, write, fsync, rename, fsync of the directory. Fails (kSystem) and leaves no temporary.
Status WriteFileAtomic(const std::filesystem::path& path, std::string_view bytes);

// Creates the directory and its parents; an existing directory is fine.
Status MakeDirectory(const std::filesystem::path& path);

}  // namespace turnlight
