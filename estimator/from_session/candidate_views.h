// Views that a session has not got and its rig could take.
#pragma once

#include <cstddef>
#include <vector>

#include "estimator/view_information.h"
#include "rig/session/session.h"

namespace turnlight::estimator::from_session {

inline constexpr std::size_t kMostCandidates = 200;

// Of a session's frames, in their order: a quarter, half and three quarters of the way from each to
// the next, by the screw that takes the one's poses to the other's; on a turntable that is a turn
// about its axis. Frames whose way turns by 120 degrees or more have none between them. If all
// have angles, the last step is gone on with, too, until the turn is whole. Halfway, and if the
// noise is known, twice and half the exposure as well. None that is within 0.05 degrees of a frame
// that is there. Of more than kMostCandidates some gaps are left out, evenly.
std::vector<CandidateView> CandidatesOf(const rig::Session& session,
                                        const std::vector<std::size_t>& frames);

}  // namespace turnlight::estimator::from_session
