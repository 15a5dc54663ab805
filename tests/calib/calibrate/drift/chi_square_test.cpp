// Proves: the tail against published values of the chi-squared distribution, and against the closed
// forms of one and two degrees of freedom far out.
#include "calib/calibrate/drift/chi_square.h"

#include <gtest/gtest.h>

#include <cmath>

namespace turnlight::calib::calibrate::drift {
namespace {

TEST(ChiSquare, HasThePublishedTails) {
  // Upper 5 % and 1 % points of the usual tables.
  EXPECT_NEAR(ChiSquareTail(3.841459, 1), 0.05, 1e-7);
  EXPECT_NEAR(ChiSquareTail(5.991465, 2), 0.05, 1e-7);
  EXPECT_NEAR(ChiSquareTail(9.487729, 4), 0.05, 1e-7);
  EXPECT_NEAR(ChiSquareTail(11.070498, 5), 0.05, 1e-7);
  EXPECT_NEAR(ChiSquareTail(26.216967, 12), 0.01, 1e-7);
  EXPECT_NEAR(ChiSquareTail(27.688250, 13), 0.01, 1e-7);
}

TEST(ChiSquare, IsOneAtNothingAndTinyFarOut) {
  EXPECT_EQ(ChiSquareTail(0.0, 3), 1.0);
  EXPECT_EQ(ChiSquareTail(-1.0, 3), 1.0);
  EXPECT_DOUBLE_EQ(ChiSquareTail(200.0, 2), std::exp(-100.0));
  EXPECT_EQ(ChiSquareTail(1e5, 5), 0.0);
}

}  // namespace
}  // namespace turnlight::calib::calibrate::drift
