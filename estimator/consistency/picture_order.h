// In which order pictures follow each other, from the pictures alone: those of a small turn are
// alike.
#pragma once

#include <cstddef>
#include <vector>

#include "estimator/consistency/small_views.h"

namespace turnlight::estimator::consistency {

// A closed tour through all pictures that is short in the root mean square difference between
// neighbours: nearest neighbours first, then shortened by reversing parts while that helps. It
// begins with the first picture; which way round it goes means nothing. Up to kMostOrdered
// pictures; of more nothing is returned.
inline constexpr std::size_t kMostOrdered = 400;
std::vector<std::size_t> TourOfPictures(const SmallViews& views);

}  // namespace turnlight::estimator::consistency
