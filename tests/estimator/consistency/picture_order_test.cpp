// Proves that pictures of a scene that turns, in any order, come back in a tour that follows the
// turning, either way round and from anywhere.
#include "estimator/consistency/picture_order.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace turnlight::estimator::consistency {
namespace {

// Two bright spots that go round, at different distances: no two angles look alike.
cv::Mat1f Spots(double angle) {
  cv::Mat1f out(40, 40);
  for (int row = 0; row < 40; ++row)
    for (int column = 0; column < 40; ++column) {
      const auto near = [&](double at, double radius) {
        const double x = column - 20.0 - radius * std::cos(at);
        const double y = row - 20.0 - radius * std::sin(at);
        return std::exp(-(x * x + y * y) / 30.0);
      };
      out(row, column) = static_cast<float>(near(angle, 12.0) + 0.5 * near(angle + 2.0, 7.0));
    }
  return out;
}

SmallViews Shown(const std::vector<int>& order, int count) {
  SmallViews views{calib::CameraModel::Pinhole(40, 40, 40, 40, 20, 20), 1, {}};
  for (const int k : order)
    views.views.push_back({Spots(2.0 * std::numbers::pi * k / count), {}, {}, {}, 0});
  return views;
}

TEST(PictureOrder, FollowsATurning) {
  constexpr int kCount = 24;
  std::vector<int> order;
  for (int k = 0; k < kCount; ++k) order.push_back(k * 7 % kCount);
  const std::vector<std::size_t> tour = TourOfPictures(Shown(order, kCount));
  ASSERT_EQ(tour.size(), static_cast<std::size_t>(kCount));
  EXPECT_EQ(tour[0], 0u);
  for (std::size_t i = 0; i < tour.size(); ++i) {
    const int here = order[tour[i]], next = order[tour[(i + 1) % tour.size()]];
    const int step = (next - here + kCount) % kCount;
    EXPECT_TRUE(step == 1 || step == kCount - 1) << here << " then " << next;
  }
}

TEST(PictureOrder, OfTwoPicturesOrOfVeryManyIsNotLookedFor) {
  EXPECT_TRUE(TourOfPictures(Shown({0, 1}, 2)).empty());
  SmallViews many = Shown({0}, 1);
  many.views.resize(kMostOrdered + 1, many.views[0]);
  EXPECT_TRUE(TourOfPictures(many).empty());
}

}  // namespace
}  // namespace turnlight::estimator::consistency
