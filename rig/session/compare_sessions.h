// Do two sessions show the same? docs/compare.md is for users.
//
// Camera, radiometry, target and the number of frames must be the same, angles, exposures and poses
// within tolerances; pictures may differ by their noise (picture_difference.h). Of as many frames
// the first is compared with the first and so on, otherwise frames of the same angle, and the
// others are in one session only.
//
// "sigmas: S" of a tolerance file is a limit for all frames together: of F frames, each of the
// quantities of a picture may be as many sigmas as the largest of F exceeds as rarely as a single
// one exceeds S, and so it is with the largest of all blocks.
#pragma once

#include <filesystem>
#include <vector>

#include "base/comparison.h"
#include "base/result.h"

namespace turnlight::rig {

// What a tolerance file may name, in the order of a comparison. Lengths are in the session's unit,
// levels are shares of white above black.
const std::vector<QuantityWord>& SessionQuantities();

// Reads both, whole. Sessions of the same content hash are the same, and nothing else is looked at.
// Fails (kInput): a session that `turnlight verify` finds a problem with.
Result<Comparison> CompareSessions(const std::filesystem::path& a, const std::filesystem::path& b,
                                   const Tolerances& tolerances);

}  // namespace turnlight::rig
