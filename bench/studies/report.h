// The pages docs/accuracy.md and docs/stability.md, made from the committed results.
#pragma once

#include <filesystem>

#include "base/result.h"

namespace turnlight::studies {

// Reads NAME.json for every study from `results` (those that are there) and reasons.json, which
// says for extreme cells, by group or "group/setting", why they are as they are. Writes
// accuracy.md, its plots in accuracy/, and stability.md into `docs`. accuracy.md begins with the
// photographs, or says that they were not measured.
Status WriteReport(const std::filesystem::path& results, const std::filesystem::path& docs);

}  // namespace turnlight::studies
