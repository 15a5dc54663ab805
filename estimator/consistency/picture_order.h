// In which order pictures follow each other, from the pictures alone: those of a small turn are
// alike.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "estimator/consistency/small_views.h"

namespace turnlight::estimator::consistency {

// A closed tour through all pictures that is short in the root mean square difference between
// neighbours: nearest neighbours first, then shortened by reversing parts while that helps. It
// begins with the first picture; which way round it goes means nothing. Only what is inside the
// masks is compared. Up to kMostOrdered pictures; of more nothing is returned.
inline constexpr std::size_t kMostOrdered = 400;
std::vector<std::size_t> TourOfPictures(const SmallViews& views);

// The pictures of two poses change places as long as that makes the costs (pose by picture) less.
// Those with a cost that is no number stay.
std::vector<std::size_t> Exchanged(const Eigen::MatrixXd& cost, std::vector<std::size_t> picture);

}  // namespace turnlight::estimator::consistency
