// Proves: picked corners are read, as corners of a plane seen from the front, and what is wrong
// with the file is told with its line.
#include "calib/calibrate/handheld/corners_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace turnlight::calib::calibrate::handheld {
namespace {

using testing::HasSubstr;

Result<CornersFile> Read(const std::string& text) {
  const auto document = ParseYaml(text, "corners.yaml");
  if (!document) return Forward(document);
  return ReadCorners(*document);
}

TEST(CornersFile, CornersAreThoseOfThePlaneSeenFromTheFront) {
  const auto file = Read(
      "size: [300, 200]\npictures:\n"
      "  - {image: a.png, corners: [[10, 20], [90, 20.5], [91, 70], [9, 71]]}\n");
  ASSERT_TRUE(file) << file.error().text;
  const PlaneView view = ViewOf(file->pictures[0], file->plane);
  EXPECT_EQ(view.name, "a.png");
  ASSERT_EQ(view.points.size(), 4u);
  EXPECT_EQ(view.points[0].p_B, Eigen::Vector2d(-150.0, 100.0));
  EXPECT_EQ(view.points[1].p_B, Eigen::Vector2d(150.0, 100.0));
  EXPECT_EQ(view.points[2].pixel, Eigen::Vector2d(91.0, 70.0));
}

TEST(CornersFile, WhatIsWrongIsToldWithItsLine) {
  EXPECT_THAT(Read("size: [300, 0]\npictures: []\n").error().text,
              HasSubstr("corners.yaml:1: size"));
  const auto three =
      Read("size: [300, 200]\npictures:\n  - {image: a.png, corners: [[1, 2], [3, 4], [5, 6]]}\n");
  ASSERT_FALSE(three);
  EXPECT_THAT(three.error().text, HasSubstr("corners.yaml:3: "));
  EXPECT_FALSE(Read("size: [300, 200]\npictures:\n  - {image: a.png, corner: 3}\n"));
}

}  // namespace
}  // namespace turnlight::calib::calibrate::handheld
