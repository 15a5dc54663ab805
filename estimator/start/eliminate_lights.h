// Backward elimination: which lights the pictures need.
#pragma once

#include <cstddef>
#include <vector>

#include "estimator/start/candidate.h"

namespace turnlight::estimator::start {

// From what is already a fit: removes every light without which the excess variance is less than
// three times as large; all of them, if there are no lights. With sample.choice.lights it stops at
// so many instead. See docs/estimation.md, "Starts".
Candidate Eliminate(const Sample& sample, const Candidate& fitted);

// The weakest lights of a scene, the weakest first, at most so many: what is tried without.
std::vector<std::size_t> WeakestLights(const model::Scene& scene, std::size_t most);

}  // namespace turnlight::estimator::start
