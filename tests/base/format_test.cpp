// Proves that Format keeps what printf would print, however long, that Listed puts commas between
// words, and that UtcNow has the shape that files hold. Does not prove that the clock is right.
#include "base/format.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/utc.h"

namespace turnlight {
namespace {

TEST(Format, PrintsWhatPrintfPrints) {
  EXPECT_EQ(Format("%d of %s: %.3g %%", 3, "four", 0.12345), "3 of four: 0.123 %");
  EXPECT_EQ(Format("%s", ""), "");
}

TEST(Format, CutsNothingOff) {
  const std::string text(5000, 'x');
  EXPECT_EQ(Format("<%s>", text.c_str()), "<" + text + ">");
}

TEST(Listed, HasCommasBetween) {
  EXPECT_EQ(Listed({}), "");
  EXPECT_EQ(Listed({"one"}), "one");
  EXPECT_EQ(Listed({"one", "two", "three"}), "one, two, three");
}

TEST(Counted, SaysOneOrMore) {
  EXPECT_EQ(Counted(1, "frame"), "1 frame");
  EXPECT_EQ(Counted(0, "frame"), "0 frames");
  EXPECT_EQ(Counted(12, "good frame"), "12 good frames");
}

TEST(Utc, IsADateAndATime) {
  EXPECT_THAT(UtcNow(), testing::MatchesRegex("20[0-9]+-[01][0-9]-[0-3][0-9]T[0-2][0-9]:[0-5][0-9]:"
                                              "[0-6][0-9].[0-9][0-9][0-9]Z"));
}

}  // namespace
}  // namespace turnlight
