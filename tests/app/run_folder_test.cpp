// Proves: what was begun is read back as it was, --pixels too, and a number of pixels that is not
// allowed is refused with what is. Does not prove what a run does with it: run_test does.
#include "app/run_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/temporary_folder.h"

namespace turnlight::app {
namespace {

using testing::HasSubstr;

TEST(RunFolder, WhatWasBegunIsReadBack) {
  for (const std::optional<std::size_t> pixels :
       {std::optional<std::size_t>(), std::optional<std::size_t>(250'000)}) {
    const TemporaryFolder place;
    const RunFolder folder(place.path());
    ASSERT_TRUE(folder.Begin("rig: {}\n", {CaptureGoal::kEstimate, "/somewhere/c.yaml", pixels}));
    const auto begun = folder.ReadBegun();
    ASSERT_TRUE(begun) << begun.error().text;
    EXPECT_EQ(begun->goal, CaptureGoal::kEstimate);
    EXPECT_EQ(begun->config, "/somewhere/c.yaml");
    EXPECT_EQ(begun->pixels, pixels);
  }
}

TEST(RunFolder, ANumberOfPixelsThatIsNotAllowedIsRefused) {
  const TemporaryFolder place;
  std::ofstream(place / "run.json")
      << R"({"format":"turnlight-run","version":1,"command":"run","pixels":3})";
  const auto begun = RunFolder(place.path()).ReadBegun();
  ASSERT_FALSE(begun);
  EXPECT_THAT(begun.error().text, HasSubstr("pixels"));
  EXPECT_THAT(begun.error().text, HasSubstr("10000"));
}

}  // namespace
}  // namespace turnlight::app
