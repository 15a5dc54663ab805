#include "bench/studies/statistics.h"

#include <algorithm>
#include <cmath>

namespace turnlight::studies {

Band BinomialBand(int trials, double probability, double level) {
  const double tail = 0.5 * (1.0 - level);
  Band band{0, trials};
  double cumulative = 0.0;
  bool low_found = false;
  for (int k = 0; k <= trials; ++k) {
    const double log_mass = std::lgamma(trials + 1.0) - std::lgamma(k + 1.0) -
                            std::lgamma(trials - k + 1.0) + k * std::log(probability) +
                            (trials - k) * std::log1p(-probability);
    cumulative += std::exp(log_mass);
    if (!low_found && cumulative > tail) {
      band.low = k;
      low_found = true;
    }
    if (cumulative >= 1.0 - tail) {
      band.high = k;
      break;
    }
  }
  return band;
}

}  // namespace turnlight::studies
