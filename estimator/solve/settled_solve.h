// A solve whose footprints and shadows are those of where it ends.
#pragma once

#include "estimator/solve/solver.h"

namespace turnlight::estimator::solve {

// Solves with the footprints that the start's lobe asks for and the shadows that its lights cast,
// and again, at most `rounds` times in all, while the solution asks for others. Both replace what
// options.evaluate says; the solution tells what it was solved with. known: shadows cast earlier;
// lights that have hardly moved since keep theirs.
Solution SolveSettled(const observe::Observations& observations, const model::Scene& start,
                      SolveOptions options, int rounds, const Shadows& known = {});

}  // namespace turnlight::estimator::solve
