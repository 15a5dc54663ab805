// Proves: whole lines come out wherever the bytes are split; what is too long or no text is dropped
// and counted, and the next line is whole again.
#include "rig/serial/line_splitter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace turnlight::rig::serial {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(LineSplitter, GivesWholeLinesHoweverTheyAreSplit) {
  const std::string text = "ok\r\n<Idle|MPos:1.000,0.000,0.000>\r\n\r\nerror:9\n";
  for (std::size_t cut = 0; cut <= text.size(); ++cut) {
    LineSplitter splitter(80);
    auto lines = splitter.Take(text.substr(0, cut));
    for (std::string& line : splitter.Take(text.substr(cut))) lines.push_back(std::move(line));
    EXPECT_THAT(lines, ElementsAre("ok", "<Idle|MPos:1.000,0.000,0.000>", "error:9")) << cut;
    EXPECT_EQ(splitter.TakeBad(), 0u);
  }
}

TEST(LineSplitter, DropsWhatIsTooLongOrNoTextAndGoesOn) {
  LineSplitter splitter(8);
  EXPECT_THAT(splitter.Take(std::string(1'000'000, 'x')), IsEmpty());
  EXPECT_THAT(splitter.Take("\nok\n12345678\n123456789\n"), ElementsAre("ok", "12345678"));
  EXPECT_THAT(splitter.Take(std::string("o\0k\nok\n", 7)), ElementsAre("ok"));
  EXPECT_THAT(splitter.Take("\xff\xfe\nok\n"), ElementsAre("ok"));
  EXPECT_EQ(splitter.TakeBad(), 4u);
  EXPECT_EQ(splitter.TakeBad(), 0u);
}

TEST(LineSplitter, ForgetsWhatHadBegun) {
  LineSplitter splitter(8);
  splitter.Take("half");
  splitter.Reset();
  EXPECT_THAT(splitter.Take("ok\n"), ElementsAre("ok"));
}

}  // namespace
}  // namespace turnlight::rig::serial
