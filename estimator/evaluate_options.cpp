#include "estimator/evaluate_options.h"

namespace turnlight::estimator {

double ValueCount(const Observations& observations, const EvaluateOptions& options) {
  return static_cast<double>(observations.used - options.shadows.left_out) * observations.channels;
}

}  // namespace turnlight::estimator
