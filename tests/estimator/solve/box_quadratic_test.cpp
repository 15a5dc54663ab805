// Proves: MinimiseInBox gives the minimum of a quadratic in a box: what a linear solve gives where
// no bound is in the way, the Karush-Kuhn-Tucker conditions on random problems of up to 20 columns,
// and what trying every set of active bounds gives for up to 4. Does not prove: anything about
// matrices that are singular other than by rows of zeros.
#include "estimator/solve/box_quadratic.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <vector>

#include "base/random.h"

namespace turnlight::estimator::solve {
namespace {

using Eigen::Index;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Problem {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd g, low, high;

  Eigen::VectorXd Minimum() const { return MinimiseInBox(matrix, g, low, high); }
  double Value(const Eigen::VectorXd& d) const { return 0.5 * d.dot(matrix * d) + g.dot(d); }
};

// Positive definite, condition below 1e4; no bounds.
Problem Unbounded(Index n, std::uint64_t seed) {
  const RandomStream random(seed, 3);
  Problem p;
  Eigen::MatrixXd jacobian(n + 2, n);
  for (Index i = 0; i < jacobian.size(); ++i)
    jacobian(i) = random.Normal(static_cast<std::uint64_t>(i));
  p.matrix = jacobian.transpose() * jacobian + 0.05 * Eigen::MatrixXd::Identity(n, n);
  p.g.resize(n);
  for (Index i = 0; i < n; ++i) p.g[i] = 3.0 * random.Normal(5000 + static_cast<std::uint64_t>(i));
  p.low.setConstant(n, -kInfinity);
  p.high.setConstant(n, kInfinity);
  return p;
}

// Every bound is 0, infinite, or somewhere; 0 is always inside or on the boundary.
Problem Boxed(Index n, std::uint64_t seed) {
  const RandomStream random(seed, 4);
  Problem p = Unbounded(n, seed);
  for (Index i = 0; i < n; ++i) {
    const auto at = 10 * static_cast<std::uint64_t>(i);
    const auto bound = [&](std::uint64_t draw) {
      const double kind = random.Uniform(at + draw);
      return kind < 0.3 ? 0.0 : kind < 0.5 ? kInfinity : random.Uniform(at + draw + 1, 0.01, 0.8);
    };
    p.low[i] = -bound(0);
    p.high[i] = bound(2);
  }
  return p;
}

TEST(BoxQuadratic, WithoutBoundsIsTheSolution) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const Problem p = Unbounded(1 + static_cast<Index>(seed % 20), seed);
    const Eigen::VectorXd expected = -p.matrix.ldlt().solve(p.g);
    EXPECT_LT((p.Minimum() - expected).norm(), 1e-9 * (1.0 + expected.norm())) << seed;
  }
}

TEST(BoxQuadratic, OptimalInRandomBoxes) {
  int at_bounds = 0, inside = 0;
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    const Problem p = Boxed(1 + static_cast<Index>(seed % 20), seed);
    const Eigen::VectorXd d = p.Minimum();
    const Eigen::VectorXd slope = p.g + p.matrix * d;
    ASSERT_TRUE(d.allFinite()) << seed;
    for (Index i = 0; i < d.size(); ++i) {
      EXPECT_GE(d[i], p.low[i]) << seed;
      EXPECT_LE(d[i], p.high[i]) << seed;
      // Downhill must lead out of the box, and nowhere else.
      const double tolerance = 1e-9 * p.matrix(i, i);
      if (d[i] > p.low[i]) {
        EXPECT_LT(slope[i], tolerance) << seed << " column " << i;
      }
      if (d[i] < p.high[i]) {
        EXPECT_GT(slope[i], -tolerance) << seed << " column " << i;
      }
      ++(d[i] == p.low[i] || d[i] == p.high[i] ? at_bounds : inside);
    }
  }
  EXPECT_GT(at_bounds, 1000);
  EXPECT_GT(inside, 1000);
}

// The best of all points where each column is at its low, at its high, or where the slope is 0.
double BestOfAllActiveSets(const Problem& p) {
  const Index n = p.g.size();
  int sets = 1;
  for (Index i = 0; i < n; ++i) sets *= 3;
  double best = kInfinity;
  for (int set = 0; set < sets; ++set) {
    Eigen::VectorXd d = Eigen::VectorXd::Zero(n);
    std::vector<Index> free;
    int code = set;
    for (Index i = 0; i < n; ++i, code /= 3) {
      if (code % 3 == 0)
        free.push_back(i);
      else
        d[i] = code % 3 == 1 ? p.low[i] : p.high[i];
    }
    if (!d.allFinite()) continue;
    if (!free.empty())
      d(free) = Eigen::VectorXd(-p.matrix(free, free).ldlt().solve((p.g + p.matrix * d)(free)));
    const bool in_box =
        ((d - p.low).array() >= -1e-12).all() && ((p.high - d).array() >= -1e-12).all();
    if (in_box) best = std::min(best, p.Value(d));
  }
  return best;
}

TEST(BoxQuadratic, NoSetOfActiveBoundsIsBetter) {
  for (std::uint64_t seed = 1000; seed < 1400; ++seed) {
    const Problem p = Boxed(1 + static_cast<Index>(seed % 4), seed);
    const double best = BestOfAllActiveSets(p);
    EXPECT_NEAR(p.Value(p.Minimum()), best, 1e-10 * (1.0 + std::abs(best))) << seed;
  }
}

TEST(BoxQuadratic, OneColumnInClosedForm) {
  const auto minimum = [](double slope, double low, double high) {
    const auto one = [](double v) { return Eigen::VectorXd::Constant(1, v).eval(); };
    return MinimiseInBox(Eigen::MatrixXd::Constant(1, 1, 2.0), one(slope), one(low), one(high))[0];
  };
  EXPECT_DOUBLE_EQ(minimum(-4.0, -1.0, 5.0), 2.0);
  EXPECT_EQ(minimum(-4.0, -1.0, 1.5), 1.5);
  EXPECT_EQ(minimum(4.0, -0.5, 1.5), -0.5);
  EXPECT_EQ(minimum(4.0, 0.0, kInfinity), 0.0);
  EXPECT_EQ(minimum(-4.0, -kInfinity, 0.0), 0.0);
  EXPECT_EQ(minimum(4.0, 0.0, 0.0), 0.0);
  EXPECT_DOUBLE_EQ(minimum(4.0, -kInfinity, 0.0), -2.0);
}

TEST(BoxQuadratic, RowsOfZerosStayAndDoNotMatter) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const Problem small = Boxed(6, seed);
    // The same with columns 2 and 5 of eight made of zeros, their slopes and bounds as they may be.
    const std::vector<Index> kept = {0, 1, 3, 4, 6, 7};
    Problem p{Eigen::MatrixXd::Zero(8, 8), Eigen::VectorXd::Zero(8),
              Eigen::VectorXd::Constant(8, -1.0), Eigen::VectorXd::Constant(8, kInfinity)};
    p.matrix(kept, kept) = small.matrix;
    p.g(kept) = small.g;
    p.low(kept) = small.low;
    p.high(kept) = small.high;
    const Eigen::VectorXd d = p.Minimum();
    EXPECT_EQ(d[2], 0.0);
    EXPECT_EQ(d[5], 0.0);
    EXPECT_LT((d(kept) - small.Minimum()).norm(), 1e-12);
  }
}

TEST(BoxQuadratic, SameBitsTwice) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const Problem p = Boxed(15, seed);
    EXPECT_TRUE(p.Minimum() == p.Minimum()) << seed;
  }
}

}  // namespace
}  // namespace turnlight::estimator::solve
