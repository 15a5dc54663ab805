// Proves that --frames takes numbers and ranges as they are meant, and says of everything else what
// is wrong with it; that the program estimates from those frames and no others. Does not prove
// anything of the estimate.
#include "app/frame_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/app/program.h"

namespace turnlight::app {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

TEST(FrameList, NumbersAndRanges) {
  EXPECT_THAT(*ParseFrames("3"), ElementsAre(3u));
  EXPECT_THAT(*ParseFrames("0-2,4,7-7"), ElementsAre(0u, 1u, 2u, 4u, 7u));
  EXPECT_THAT(*ParseFrames(" 0 - 1 , 5"), ElementsAre(0u, 1u, 5u));
}

TEST(FrameList, SaysWhatIsWrong) {
  const auto refusal = [](const std::string& text) {
    const auto frames = ParseFrames(text);
    return frames ? "none" : frames.error().text;
  };
  for (const char* misspelt :
       {"", "a", "1,,2", "1-", "-3", "0..5", "1;2", "1.5", "0-2-4", "0x3", "9999999999"})
    EXPECT_THAT(refusal(misspelt),
                AllOf(HasSubstr("is neither a frame's number nor a range"),
                      HasSubstr("counted from 0 and ascending, such as 0-16,18-35")))
        << misspelt;
  EXPECT_THAT(refusal("7-3"), HasSubstr("--frames: \"7-3\" goes backwards"));
  EXPECT_THAT(refusal("5,3"), HasSubstr("\"3\" comes after frame 5"));
  EXPECT_THAT(refusal("0-5,4-8"), HasSubstr("frame 4 is named twice"));
  EXPECT_THAT(refusal("3,3"), HasSubstr("frame 3 is named twice"));
}

TEST(FrameList, TheProgramTakesThoseFrames) {
  const TemporaryFolder folder;
  WriteSession(SmallConfig(), folder / "session");
  const auto estimate = [&](const std::string& out, std::vector<std::string> more) {
    std::vector<std::string> line{"estimate", folder / "session", "--out", folder / out,
                                  "--no-pictures"};
    line.insert(line.end(), more.begin(), more.end());
    return RunProgram(line);
  };
  ASSERT_EQ(estimate("all", {"--frames", "0-2"}).exit_code, 0);
  ASSERT_EQ(estimate("whole", {}).exit_code, 0);
  EXPECT_EQ(ResultWithoutTimes(folder / "all"), ResultWithoutTimes(folder / "whole"));
  ASSERT_EQ(estimate("two", {"--frames", "0,2"}).exit_code, 0);
  EXPECT_EQ(nlohmann::json::parse(ReadText(folder / "two/result.json"))["views"], 2);
  const Outcome beyond = estimate("beyond", {"--frames", "1-3"});
  EXPECT_EQ(beyond.exit_code, 2);
  EXPECT_THAT(beyond.err, HasSubstr("--frames: 3, allowed are 0 to 2, the session's 3 frames"));
  const Outcome both = estimate("both", {"--frames", "1", "--views", "2"});
  EXPECT_EQ(both.exit_code, 2);
  EXPECT_THAT(both.err, HasSubstr("--frames: not with --views"));
}

}  // namespace
}  // namespace turnlight::app
