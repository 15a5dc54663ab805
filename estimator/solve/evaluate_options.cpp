#include "estimator/solve/evaluate_options.h"

namespace turnlight::estimator::solve {

double ValueCount(const observe::Observations& observations, const EvaluateOptions& options) {
  const double pixels = observations.independent > 0.0
                            ? observations.independent
                            : static_cast<double>(observations.used - options.shadows.left_out);
  return pixels * observations.channels;
}

}  // namespace turnlight::estimator::solve
