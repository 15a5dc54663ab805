// Proves that slips of the finger find their word and other words find none. Does not prove that
// messages use it; the tests of those messages do.
#include "base/nearest.h"

#include <gtest/gtest.h>

namespace turnlight {
namespace {

TEST(Nearest, FindsSlipsOfTheFingerOnly) {
  const std::vector<std::string> words{"--method", "--views", "--out"};
  EXPECT_EQ(Nearest("--metod", words), "--method");
  EXPECT_EQ(Nearest("--mehtod", words), "--method");
  EXPECT_EQ(Nearest("--view", words), "--views");
  EXPECT_EQ(Nearest("--outt", words), "--out");
  EXPECT_EQ(Nearest("--something", words), "");
  EXPECT_EQ(Nearest("", words), "");
  EXPECT_EQ(Nearest(std::string(10000, 'x'), words), "");
  EXPECT_EQ(Nearest("x", std::vector<std::string>{"y"}), "");
}

TEST(Nearest, CountsASwapOfNeighboursOnce) {
  EXPECT_EQ(EditDistance("rig", "rgi"), 1u);
  EXPECT_EQ(EditDistance("rig", "rigg"), 1u);
  EXPECT_EQ(EditDistance("rig", "graph"), 4u);
  EXPECT_EQ(EditDistance("", "rig"), 3u);
}

TEST(Nearest, TheFirstOfEqualsIsNamed) {
  EXPECT_EQ(DidYouMean("nam", std::vector<std::string>{"name", "naming", "names"}),
            " (did you mean \"name\"?)");
  EXPECT_EQ(DidYouMean("camera", std::vector<std::string>{"graph"}), "");
}

}  // namespace
}  // namespace turnlight
