// Proves that each square has the colour of its pair, that a gap parts the lights, that numbers are
// there where there is room, and that no text is cut at the page's edge whatever the size. Does not
// prove that the picture pleases: that takes eyes.
#include "estimator/pictures/correlation_picture.h"

#include <gtest/gtest.h>

#include "base/plot/chart.h"
#include "tests/base/plot/clear_edge.h"

namespace turnlight::estimator::pictures {
namespace {

// Of so many rows, the first half of a light.
uncertainty::Correlation OfSize(int count) {
  uncertainty::Correlation out;
  out.matrix.resize(count, count);
  for (int i = 0; i < count; ++i) {
    const bool of_light = i < count / 2;
    out.quantities.push_back(
        {of_light ? "diffuse product" : "ambient harmonic " + std::to_string(i),
         of_light ? "green" : "",
         {},
         1.0});
    if (of_light) out.quantities.back().light = 0;
    for (int j = 0; j < count; ++j) out.matrix(i, j) = i == j ? 1.0 : (i + j) % 2 == 0 ? 0.6 : -0.9;
  }
  return out;
}

// How many pixels of the colour there are.
int CountOf(const cv::Mat3b& page, const cv::Vec3b& colour) {
  int count = 0;
  for (const cv::Vec3b& pixel : page) count += pixel == colour ? 1 : 0;
  return count;
}

TEST(CorrelationPicture, EachSquareHasItsColour) {
  constexpr int kCount = 40, kSquare = 920 / kCount - 1;
  const cv::Mat3b page = CorrelationPicture(OfSize(kCount));
  // The colour bar has one row at most of a colour, 16 pixels wide.
  const auto squares = [&](double r) {
    return CountOf(page, plot::DivergingColour(r)) / double(kSquare * kSquare);
  };
  EXPECT_NEAR(squares(1.0), kCount, 1.0);
  EXPECT_NEAR(squares(0.6), kCount * (0.5 * kCount - 1.0), 1.0);
  EXPECT_NEAR(squares(-0.9), 0.5 * kCount * kCount, 1.0);
}

TEST(CorrelationPicture, TheLargestCorrelationIsTopLeftAndAGapPartsTheLight) {
  constexpr int kCount = 40, kPitch = 920 / kCount;
  const cv::Mat3b page = CorrelationPicture(OfSize(kCount));
  // The matrix begins below the title; its first column is the first square's.
  const int top = plot::kTitleHeight;
  int left = 0;
  while (page(top, left) != plot::DivergingColour(1.0)) ++left;
  EXPECT_EQ(page(top, left + kPitch), plot::DivergingColour(-0.9));
  const int half = kCount / 2 * kPitch;
  EXPECT_EQ(page(top, left + half - 1), plot::kFaint);
  for (int x = half; x < half + 4; ++x) EXPECT_EQ(page(top, left + x), plot::kPaper) << x;
  EXPECT_EQ(page(top, left + half + 4), plot::kFaint);
  EXPECT_EQ(page(top, left + half + 5), plot::DivergingColour(0.6));
}

TEST(CorrelationPicture, NothingIsCutAtTheEdge) {
  for (const int count : {2, 3, 10, 20, 21, 60, 200})
    plot::ExpectClearEdge(CorrelationPicture(OfSize(count)));
}

TEST(CorrelationPicture, NumbersStandWhereThereIsRoom) {
  const auto covered = [](int count, int square) {
    const cv::Mat3b page = CorrelationPicture(OfSize(count));
    return CountOf(page, plot::DivergingColour(-0.9)) / (0.5 * count * count * square * square);
  };
  EXPECT_LT(covered(20, 45), 0.95);
  EXPECT_NEAR(covered(22, 40), 1.0, 0.01);
}

TEST(CorrelationPicture, OnePairIsTheLeast) {
  EXPECT_FALSE(HasCorrelationPicture({}));
  EXPECT_FALSE(HasCorrelationPicture(OfSize(1)));
  EXPECT_TRUE(HasCorrelationPicture(OfSize(2)));
  EXPECT_TRUE(HasCorrelationPicture(OfSize(200)));
  EXPECT_FALSE(HasCorrelationPicture(OfSize(201)));
}

}  // namespace
}  // namespace turnlight::estimator::pictures
