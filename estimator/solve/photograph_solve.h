// How photographs are solved (observe/photograph.h): by what is expected to be left of each pixel.
#pragma once

#include <cstddef>

#include "estimator/solve/solver.h"

namespace turnlight::estimator::solve {

// Lights are distant, pixels as wide as a demosaiced camera blurs them, the diffuse part's
// departures from its model held to 10 % or so, and Huber's loss from one expected sigma on.
SolveOptions PhotographSolveOptions(std::size_t lights);

}  // namespace turnlight::estimator::solve
