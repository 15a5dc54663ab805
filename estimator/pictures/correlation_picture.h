// How the errors of an estimate go together, as a page. R, G, B.
#pragma once

#include <opencv2/core.hpp>

#include "estimator/estimate.h"

namespace turnlight::estimator::pictures {

// Whether there is something to show: two errors or more, and not more than a page is drawn of
// (uncertainty::kMostCorrelated).
bool HasCorrelationPicture(const uncertainty::Correlation& correlation);

// The matrix, a square for each pair of quantities, from -1 to 1 in blue, white, red with a colour
// bar; each row and column with its name, a gap after each light's. Up to 20 rows the numbers stand
// in their squares.
cv::Mat3b CorrelationPicture(const uncertainty::Correlation& correlation);

}  // namespace turnlight::estimator::pictures
