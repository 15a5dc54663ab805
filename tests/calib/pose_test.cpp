// Proves: poses go to rows and back unchanged, compose and invert as transforms do, and rows that
// are no rigid transform are refused with the measured and the allowed value. Does not prove: that
// a rig's poses are the right ones.
#include "calib/pose.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace turnlight::calib {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

Pose Example() {
  Pose pose;
  pose.rotation =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  pose.translation = {10.0, -20.5, 300.25};
  return pose;
}

std::string RefusalOf(const std::vector<double>& rows) {
  const auto pose = PoseFromRows(rows, "session.json: frames/3/X_WC");
  if (pose) return "accepted";
  EXPECT_EQ(pose.error().kind, ErrorKind::kInput);
  EXPECT_THAT(pose.error().text, testing::StartsWith("session.json: frames/3/X_WC: "));
  return pose.error().text;
}

TEST(Pose, RowsAndBack) {
  const auto rows = RowsFromPose(Example());
  ASSERT_EQ(rows.size(), 12u);
  EXPECT_EQ(rows[3], 10.0);
  EXPECT_EQ(rows[11], 300.25);
  EXPECT_EQ(rows[1], Example().rotation(0, 1));
  const auto pose = PoseFromRows(rows, "x");
  ASSERT_TRUE(pose) << pose.error().text;
  EXPECT_EQ(pose->rotation, Example().rotation);
  EXPECT_EQ(pose->translation, Example().translation);
}

TEST(Pose, ComposesAndInverts) {
  const Pose X_AB = Example();
  const Pose X_BC = X_AB * X_AB;
  const Eigen::Vector3d p_C(1, 2, 3);
  EXPECT_LT(((X_AB * X_BC) * p_C - X_AB * (X_BC * p_C)).norm(), 1e-12);
  EXPECT_LT((X_AB.Inverse() * (X_AB * p_C) - p_C).norm(), 1e-12);
}

TEST(Pose, NotFinite) {
  for (const double bad : {double{NAN}, double{INFINITY}, -double{INFINITY}}) {
    for (std::size_t i = 0; i < 12; ++i) {
      auto rows = RowsFromPose(Example());
      rows[i] = bad;
      EXPECT_THAT(RefusalOf(rows), AllOf(HasSubstr("row " + std::to_string(i / 4) + ", column " +
                                                   std::to_string(i % 4)),
                                         HasSubstr("allowed is a finite number")));
    }
  }
}

TEST(Pose, Reflection) {
  Pose pose = Example();
  pose.rotation.col(2) *= -1.0;
  EXPECT_THAT(RefusalOf(RowsFromPose(pose)),
              AllOf(HasSubstr("reflection"), HasSubstr("determinant is -1"), HasSubstr("+1")));
}

TEST(Pose, ScaledRotation) {
  Pose pose = Example();
  pose.rotation *= 1.01;
  EXPECT_THAT(RefusalOf(RowsFromPose(pose)),
              AllOf(HasSubstr("not orthonormal"), HasSubstr("0.0201"), HasSubstr("1e-06")));
  EXPECT_THAT(RefusalOf(RowsFromPose(pose)), Not(HasSubstr("more digits")));
  pose.rotation.setZero();
  EXPECT_THAT(RefusalOf(RowsFromPose(pose)), HasSubstr("not orthonormal"));
  pose.rotation.setConstant(1e200);
  EXPECT_THAT(RefusalOf(RowsFromPose(pose)), HasSubstr("not orthonormal"));
}

TEST(Pose, ToleranceIsOnePartInAMillion) {
  Pose pose = Example();
  pose.rotation *= 1.0 + 0.4e-6;  // R'R is off by 0.8e-6
  EXPECT_EQ(RefusalOf(RowsFromPose(pose)), "accepted");
  pose.rotation = Example().rotation * (1.0 + 0.6e-6);
  EXPECT_THAT(RefusalOf(RowsFromPose(pose)),
              AllOf(HasSubstr("not orthonormal"), HasSubstr("Write more digits")));
}

TEST(Pose, WrongCount) {
  EXPECT_THAT(RefusalOf({1, 2, 3}), AllOf(HasSubstr("3 numbers"), HasSubstr("3 rows of 4")));
}

}  // namespace
}  // namespace turnlight::calib
