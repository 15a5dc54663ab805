#pragma once

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

namespace turnlight::plot {

// Nothing is drawn within four pixels of the page's edge.
inline void ExpectClearEdge(const cv::Mat3b& page) {
  cv::Mat1b edge(page.size(), uchar{255});
  edge(cv::Rect(4, 4, page.cols - 8, page.rows - 8)).setTo(0);
  cv::Mat ink;
  cv::bitwise_not(page, ink);
  EXPECT_EQ(cv::norm(ink, cv::NORM_INF, edge), 0.0);
}

}  // namespace turnlight::plot
