// Proves: a file of picked points is read, and what is wrong in one is named with its line.
#include "calib/calibrate/placement/picked_points.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/file.h"
#include "tests/temporary_folder.h"

namespace turnlight::calib::calibrate::placement {
namespace {

using testing::EndsWith;
using testing::HasSubstr;

Result<std::vector<PickedPoint>> ReadText(const std::string& text) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "points.csv";
  if (Status status = WriteFileAtomic(path, text); !status) return Forward(status);
  return ReadPickedPoints(path, 3);
}

TEST(PickedPoints, ReadsCommasAndSpaces) {
  const auto points =
      ReadText("frame,x,y,X,Y,Z\n# a remark\n0, 10.5, 20, 1, 2, -3\r\n\n2 1 2 3 4 5e-1\n");
  ASSERT_TRUE(points) << points.error().text;
  ASSERT_EQ(points->size(), 2u);
  EXPECT_EQ((*points)[0].pixel, Eigen::Vector2d(10.5, 20.0));
  EXPECT_EQ((*points)[0].p_T, Eigen::Vector3d(1.0, 2.0, -3.0));
  EXPECT_EQ((*points)[1].view, 2u);
  EXPECT_THAT((*points)[1].where, EndsWith("points.csv:5"));
}

TEST(PickedPoints, NamesWhatIsWrong) {
  EXPECT_THAT(ReadText("0 1 2 3 4\n").error().text, HasSubstr(":1: 5 values, allowed are six"));
  EXPECT_THAT(ReadText("0 1 2 3 4 5\n0 1 2 x 4 5\n").error().text,
              HasSubstr(":2: \"x\", allowed is a number"));
  EXPECT_THAT(ReadText("3 1 2 3 4 5\n").error().text,
              HasSubstr("frame 3, allowed is a whole number from 0 to 2"));
  EXPECT_THAT(ReadText("0 1 nan 3 4 5\n").error().text, HasSubstr("\"nan\""));
  EXPECT_THAT(ReadText("# nothing\n").error().text, HasSubstr("no points"));
}

}  // namespace
}  // namespace turnlight::calib::calibrate::placement
