// A frame of a session as the estimator takes it.
#pragma once

#include <cstddef>

#include "base/result.h"
#include "estimator/model/keyframe.h"
#include "rig/session/picture_notes.h"
#include "rig/session/session.h"

namespace turnlight::estimator::from_session {

// Reads and linearises. facts (optional) receives what the picture's file says. Fails as
// rig::ReadFrameImages does.
Result<model::Keyframe> ReadKeyframe(const rig::Session& session, std::size_t frame,
                                     rig::PictureFacts* facts = nullptr);

}  // namespace turnlight::estimator::from_session
