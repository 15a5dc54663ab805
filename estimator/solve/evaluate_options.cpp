#include "estimator/solve/evaluate_options.h"

namespace turnlight::estimator::solve {

double ValueCount(const observe::Observations& observations, const EvaluateOptions& options) {
  return static_cast<double>(observations.used - options.shadows.left_out) * observations.channels;
}

}  // namespace turnlight::estimator::solve
