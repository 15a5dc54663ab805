// Proves: a mark is drawn where its direction is, and the page grows with the list below the map.
#include "base/plot/sky_map.h"

#include <gtest/gtest.h>

#include <limits>

namespace turnlight::plot {
namespace {

TEST(SkyMap, AnglesAreAzimuthAndZenith) {
  EXPECT_EQ(SkyAngles({0.0, -1.0, 0.0}), "azimuth 270.00\xC2\xB0,  zenith 90.00\xC2\xB0");
}

TEST(SkyMap, AMarkIsAtItsDirection) {
  const cv::Mat1f map(90, 180, std::numeric_limits<float>::quiet_NaN());
  const cv::Mat3b without = SkyMap(map, {"Title", "unit"}, {});
  const cv::Mat3b with = SkyMap(map, {"Title", "unit"}, {{{0.0, 1.0, 0.0}, 0.0, "1", "1: words"}});
  EXPECT_EQ(with.rows, without.rows + 22);
  // Azimuth 90 of 360 degrees over 1080 pixels, zenith 90 of 180 over 540, beside the ring's
  // middle.
  bool drawn = false;
  for (int row = 44 + 270 - 14; row < 44 + 270 + 14; ++row)
    for (int column = 84 + 270 - 14; column < 84 + 270 + 14; ++column)
      drawn = drawn || with(row, column) != without(row, column);
  EXPECT_TRUE(drawn);
  EXPECT_EQ(with(44 + 100, 84 + 800), without(44 + 100, 84 + 800));
}

}  // namespace
}  // namespace turnlight::plot
