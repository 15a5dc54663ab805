// Keyframes that an earlier run of a capture has stored, as the estimator took them then.
#pragma once

#include <filesystem>

#include "base/result.h"
#include "calib/radiometry.h"
#include "estimator/model/keyframe.h"
#include "rig/session/journal.h"

namespace turnlight::nodes {

// session: of what is stored; root: the session's folder. Fails (kInput) as reading a picture does.
Result<estimator::model::Keyframe> ReadKept(const std::filesystem::path& root,
                                            const rig::JournalEntry& entry,
                                            const calib::Radiometry& session);

}  // namespace turnlight::nodes
