// Proves that pictures of a scene that turns, in any order, come back in a tour that follows the
// turning, either way round and from anywhere.
#include "estimator/consistency/picture_order.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <set>

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

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(PictureOrder, OfPicturesThatAreNoNumbersIsSomeOrder) {
  SmallViews views = Shown({0, 3, 1, 4, 2, 5}, 6);
  views.views[1].radiance.setTo(kNan);
  views.views[4].radiance(7, 7) = std::numeric_limits<float>::infinity();
  const std::vector<std::size_t> tour = TourOfPictures(views);
  EXPECT_EQ(std::set<std::size_t>(tour.begin(), tour.end()).size(), 6u);
  EXPECT_EQ(tour.size(), 6u);
}

TEST(PictureOrder, WhatTheMasksLeaveOutIsNotCompared) {
  std::vector<int> order;
  for (int k = 0; k < 12; ++k) order.push_back(k * 5 % 12);
  SmallViews views = Shown(order, 12);
  for (SmallView& view : views.views) {
    view.mask = cv::Mat1b(40, 40, std::uint8_t{255});
    view.mask.rowRange(0, 2).setTo(0);
  }
  const std::vector<std::size_t> tour = TourOfPictures(views);
  for (std::size_t k = 0; k < 12; ++k)
    views.views[k].radiance.rowRange(0, 2).setTo(static_cast<double>(k * 7 % 12));
  EXPECT_EQ(TourOfPictures(views), tour);
}

TEST(PictureOrder, CostsThatAreNoNumbersAreNotExchanged) {
  Eigen::MatrixXd cost = Eigen::MatrixXd::Ones(3, 3);
  cost.diagonal().setZero();
  EXPECT_EQ(Exchanged(cost, {1, 0, 2}), (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_EQ(Exchanged(Eigen::MatrixXd::Constant(3, 3, kNan), {1, 0, 2}),
            (std::vector<std::size_t>{1, 0, 2}));
  cost.row(2).setConstant(kNan);
  EXPECT_EQ(Exchanged(cost, {1, 0, 2}), (std::vector<std::size_t>{0, 1, 2}));
}

TEST(PictureOrder, OfTwoPicturesOrOfVeryManyIsNotLookedFor) {
  EXPECT_TRUE(TourOfPictures(Shown({0, 1}, 2)).empty());
  SmallViews many = Shown({0}, 1);
  many.views.resize(kMostOrdered + 1, many.views[0]);
  EXPECT_TRUE(TourOfPictures(many).empty());
}

}  // namespace
}  // namespace turnlight::estimator::consistency
