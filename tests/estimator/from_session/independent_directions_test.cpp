// Proves: the columns are a square root of the joint covariance, singular ones and rows of
// different units included; blocks that are not correlated have columns of their own rows alone;
// and the order of blocks does not matter. Nothing is proven of what the blocks mean.
#include "estimator/from_session/independent_directions.h"

#include <gtest/gtest.h>

#include <cmath>

namespace turnlight::estimator::from_session {
namespace {

// Of any size, with rows of different units.
Eigen::MatrixXd Covariance(Eigen::Index size, Eigen::Index rank) {
  Eigen::MatrixXd root(size, rank);
  for (Eigen::Index i = 0; i < size; ++i)
    for (Eigen::Index k = 0; k < rank; ++k)
      root(i, k) = std::pow(10.0, static_cast<double>(i % 4) - 2.0) *
                   std::sin(1.0 + static_cast<double>((i + 3 * k) * (i + k * size)));
  return root * root.transpose();
}

bool Same(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const Eigen::VectorXd sigma = b.diagonal().cwiseSqrt().array() + 1e-300;
  return ((a - b).array() / (sigma * sigma.transpose()).array()).abs().maxCoeff() < 1e-6;
}

TEST(RootOf, IsASquareRootWithAsManyColumnsAsThereAreDirections) {
  const Eigen::MatrixXd full = Covariance(6, 6), singular = Covariance(6, 3);
  EXPECT_EQ(RootOf(full).root.cols(), 6);
  const BlockRoot root = RootOf(singular);
  EXPECT_EQ(root.root.cols(), 3);
  EXPECT_TRUE(Same(root.root * root.root.transpose(), singular));
  EXPECT_TRUE((root.inverse * root.root).isIdentity(1e-6));
  EXPECT_EQ(RootOf(Eigen::MatrixXd::Zero(6, 6)).root.cols(), 0);
  EXPECT_EQ(RootOf(Eigen::MatrixXd(0, 0)).root.cols(), 0);
}

TEST(JointRoot, IsASquareRootOfTheWhole) {
  const Eigen::MatrixXd whole = Covariance(7, 7);
  const Eigen::MatrixXd first = whole.topLeftCorner(4, 4), last = whole.bottomRightCorner(3, 3);
  const Eigen::MatrixXd root = JointRoot(whole, {RootOf(first), RootOf(last)});
  EXPECT_EQ(root.cols(), 7);
  EXPECT_TRUE(Same(root * root.transpose(), whole));
}

TEST(JointRoot, OfBlocksThatAreNotCorrelatedIsTheirOwn) {
  Eigen::MatrixXd whole = Covariance(7, 7);
  whole.topRightCorner(4, 3).setZero();
  whole.bottomLeftCorner(3, 4).setZero();
  const Eigen::MatrixXd root =
      JointRoot(whole, {RootOf(whole.topLeftCorner(4, 4)), RootOf(whole.bottomRightCorner(3, 3))});
  EXPECT_TRUE(root.topRightCorner(4, 3).isZero(0.0));
  EXPECT_TRUE(root.bottomLeftCorner(3, 4).isZero(0.0));
  EXPECT_TRUE(Same(root * root.transpose(), whole));
}

TEST(JointRoot, TreatsBlocksAlike) {
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(1, 1);
  Eigen::MatrixXd whole(2, 2);
  whole << 1.0, 0.6, 0.6, 1.0;
  const Eigen::MatrixXd root = JointRoot(whole, {RootOf(one), RootOf(one)});
  EXPECT_NEAR(std::abs(root(0, 0)), std::abs(root(1, 1)), 1e-12);
  EXPECT_NEAR(std::abs(root(0, 1)), std::abs(root(1, 0)), 1e-12);
  EXPECT_GT(std::abs(root(0, 0)), std::abs(root(0, 1))) << "each is nearest to its own";
}

}  // namespace
}  // namespace turnlight::estimator::from_session
