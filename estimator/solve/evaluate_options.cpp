#include "estimator/solve/evaluate_options.h"

namespace turnlight::estimator::solve {

double ValueCount(const observe::Observations& observations, const EvaluateOptions& options) {
  if (observations.independent > 0.0) return observations.independent * observations.channels;
  std::size_t pixels = observations.used - options.shadows.left_out;
  // At white nothing is left as a rule.
  if (observations.one_sided)
    for (const observe::HeldBack& held : observations.held_back)
      pixels -= held.at_white == observe::kBesideWhite ? 0 : 1;
  return static_cast<double>(pixels) * observations.channels;
}

}  // namespace turnlight::estimator::solve
