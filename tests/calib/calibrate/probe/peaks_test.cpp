// Proves: peaks are told apart by how far they stand above the saddle between them, and a flood
// stays within what is connected.
#include "calib/calibrate/probe/peaks.h"

#include <gtest/gtest.h>

namespace turnlight::calib::calibrate::probe {
namespace {

cv::Mat1f Row(std::initializer_list<float> values) {
  cv::Mat1f row(1, static_cast<int>(values.size()));
  std::copy(values.begin(), values.end(), row.begin());
  return row;
}

TEST(Peaks, DeepSaddlesSeparate) {
  const cv::Mat1f map = Row({0, 9, 10, 2, 8, 7, 0});
  const auto peaks = FindPeaks(map, cv::Mat1b::ones(map.size()), 0.5f, 0.35f, 0.0f);
  ASSERT_EQ(peaks.size(), 2u);
  EXPECT_EQ(peaks[0].at, cv::Point(2, 0));
  EXPECT_EQ(peaks[1].at, cv::Point(4, 0));
  EXPECT_FLOAT_EQ(peaks[0].saddle, 2.0f);
  EXPECT_FLOAT_EQ(peaks[1].saddle, 2.0f);
}

TEST(Peaks, ShallowSaddlesDoNot) {
  const cv::Mat1f map = Row({0, 10, 7, 8, 0});
  const auto peaks = FindPeaks(map, cv::Mat1b::ones(map.size()), 0.5f, 0.35f, 0.0f);
  ASSERT_EQ(peaks.size(), 1u);
  EXPECT_FLOAT_EQ(peaks[0].saddle, 0.0f);
}

TEST(Peaks, NoiseIsNoPeak) {
  const cv::Mat1f map = Row({0, 10, 1, 2, 1, 0});
  EXPECT_EQ(FindPeaks(map, cv::Mat1b::ones(map.size()), 0.5f, 0.35f, 3.0f).size(), 1u);
}

TEST(Peaks, WhatTheRegionLeavesOutIsNotThere) {
  cv::Mat1b region = cv::Mat1b::ones(1, 5);
  region(0, 2) = 0;
  const cv::Mat1f map = Row({5, 6, 6, 7, 5});
  EXPECT_EQ(FindPeaks(map, region, 0.5f, 0.35f, 0.0f).size(), 2u);
}

TEST(Peaks, AFloodStopsBelowItsLevel) {
  const cv::Mat1f map = Row({5, 6, 2, 7, 5});
  const cv::Mat1b flooded = FloodFrom(map, cv::Mat1b::ones(map.size()), {3, 0}, 4.0f);
  EXPECT_EQ(cv::countNonZero(flooded), 2);
  EXPECT_EQ(flooded(0, 1), 0);
}

}  // namespace
}  // namespace turnlight::calib::calibrate::probe
